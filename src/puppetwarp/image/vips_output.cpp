#include <puppetwarp/image/vips_output.h>

#include <puppetwarp/base/errors.h>

#include <opencv2/core.hpp>

#include <unistd.h>

namespace puppetwarp {

VipsOutput::VipsOutput(OutputFile& file) : file_(file), target_(VIPS_TARGET(vips_target_custom_new())) {
    g_signal_connect(target_.get(), "write", G_CALLBACK(write), this);
    g_signal_connect(target_.get(), "read", G_CALLBACK(read), this);
    g_signal_connect(target_.get(), "seek", G_CALLBACK(seek), this);
}

gint64 VipsOutput::write(VipsTargetCustom*, const void* bytes, gint64 count, gpointer self) {
    auto& output = *static_cast<VipsOutput*>(self);
    try {
        output.file_.write({static_cast<const char*>(bytes), static_cast<std::size_t>(count)});
        return count;
    } catch (...) {
        output.failure_ = std::current_exception();
        return -1;
    }
}

gint64 VipsOutput::read(VipsTargetCustom*, void* bytes, gint64 count, gpointer self) {
    return ::read(static_cast<VipsOutput*>(self)->file_.descriptor(), bytes, static_cast<std::size_t>(count));
}

gint64 VipsOutput::seek(VipsTargetCustom*, gint64 offset, int whence, gpointer self) {
    return ::lseek(static_cast<VipsOutput*>(self)->file_.descriptor(), offset, whence);
}

void VipsOutput::finish(int status) const {
    const std::string reason = status == 0 ? "" : take_vips_error();
    if (failure_) std::rethrow_exception(failure_);
    if (status != 0) throw MachineFault(file_.target().string(), "cannot be written: " + reason);
}

VipsPixelType vips_pixel_type(int type) {
    const bool grey = CV_MAT_CN(type) <= 2;
    switch (CV_MAT_DEPTH(type)) {
        case CV_8U: return {VIPS_FORMAT_UCHAR, grey ? VIPS_INTERPRETATION_B_W : VIPS_INTERPRETATION_sRGB};
        case CV_16U: return {VIPS_FORMAT_USHORT, grey ? VIPS_INTERPRETATION_GREY16 : VIPS_INTERPRETATION_RGB16};
        default: return {VIPS_FORMAT_FLOAT, grey ? VIPS_INTERPRETATION_B_W : VIPS_INTERPRETATION_sRGB};
    }
}

VipsImagePtr vips_view(const cv::Mat& pixels) {
    CV_Assert(pixels.isContinuous() && pixels.channels() <= 4);
    const VipsPixelType type = vips_pixel_type(pixels.type());
    VipsImagePtr image(vips_image_new_from_memory(pixels.data, pixels.total() * pixels.elemSize(), pixels.cols,
                                                  pixels.rows, pixels.channels(), type.format));
    if (!image) throw MachineFault("libvips", "cannot take a picture: " + take_vips_error());
    image->Type = type.interpretation;
    return image;
}

std::string encoded(const std::string& name, const std::function<int(void** bytes, std::size_t* count)>& save) {
    void* bytes = nullptr;
    std::size_t count = 0;
    if (save(&bytes, &count) != 0) throw MachineFault(name, "cannot be encoded: " + take_vips_error());
    const std::unique_ptr<void, decltype(&g_free)> owned(bytes, g_free);
    return {static_cast<const char*>(bytes), count};
}

}  // namespace puppetwarp
