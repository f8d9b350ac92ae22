#pragma once

#include <puppetwarp/base/output_file.h>

#include <puppetwarp/image/vips_session.h>

#include <opencv2/core/mat.hpp>

#include <exception>
#include <functional>
#include <string>
#include <string_view>

namespace puppetwarp {

//! A target for libvips' savers over an OutputFile. What the file throws is kept and thrown by `finish`.
class VipsOutput {
public:
    explicit VipsOutput(OutputFile& file);
    VipsOutput(const VipsOutput&) = delete;
    VipsOutput& operator=(const VipsOutput&) = delete;

    VipsTarget* target() const { return target_.get(); }
    //! \param status  what the saver returned. \throw MachineFault  it failed.
    void finish(int status) const;

private:
    static gint64 write(VipsTargetCustom*, const void* bytes, gint64 count, gpointer self);
    static gint64 read(VipsTargetCustom*, void* bytes, gint64 count, gpointer self);
    static gint64 seek(VipsTargetCustom*, gint64 offset, int whence, gpointer self);

    OutputFile& file_;
    VipsTargetPtr target_;
    std::exception_ptr failure_;
};

//! How libvips calls a matrix's type, CV_8U, CV_16U or CV_32F with 1 to 4 channels.
struct VipsPixelType {
    VipsBandFormat format;
    VipsInterpretation interpretation;  //!< else savers guess, and bring 16 bits or floats to what they think of them
};
VipsPixelType vips_pixel_type(int type);

//! The matrix as a picture of libvips, sharing its memory. \param pixels  continuous, 1 to 4 channels of CV_8U, CV_16U,
//! CV_32F.
VipsImagePtr vips_view(const cv::Mat& pixels);

//! A whole encoded file in memory, as a saver of libvips makes it.
//! \param save  calls `vips_..save_buffer` and returns its status.
//! \throw MachineFault  the saver failed.
std::string encoded(const std::string& name, const std::function<int(void** bytes, std::size_t* count)>& save);

}  // namespace puppetwarp
