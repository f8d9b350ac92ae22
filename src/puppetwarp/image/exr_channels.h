#pragma once

#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <puppetwarp/image/fill_rows.h>
#include <puppetwarp/image/picture_file.h>

#include <opencv2/core/mat.hpp>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace puppetwarp {

// EXR files as what they are beside pictures: any number of named channels of numbers over a window of a plane.

//! Whole pixels of a plane, rows downwards.
struct PixelWindow {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

//! What the first part's header says.
struct ChannelLayout {
    std::vector<std::string> channels;      //!< full names: `R`, `layer.x`
    PixelWindow data;                       //!< the pixels that there are
    PixelWindow display;                    //!< the frame they belong to
    std::map<std::string, double> numbers;  //!< attributes of one number that OpenEXR itself does not know
    std::set<std::string> halves;           //!< channels of 16-bit floats
};

//! \throw InvalidInput  damaged, deep, over `max_pixels`.
ChannelLayout read_exr_layout(const PictureFile& file, const ReadOptions& options);

//! Reads some channels, as stored, a few rows at a time from the top.
//! \param take  is given rows of CV_32F with a channel for each that was asked for, in that order.
//! \throw InvalidInput  as above, a channel of less than the full resolution.   \throw MachineFault  out of memory.
void read_exr_channels(const PictureFile& file, const std::vector<std::string>& channels, const ReadOptions& options,
                       const TakeRows& take);

//! Writes 32-bit floats, a few rows at a time, ZIP-compressed unless `options.compression` is 0.
//! \param layout  Numbers are written as doubles.
//! \param fill    rows are of CV_32F, with a channel for each of the layout's in their order.
//! \throw MachineFault  disk full. What `fill` throws is passed on.
void write_exr_channels(const ChannelLayout& layout, const FillRows& fill, const WriteOptions& options,
                        OutputFile& file);

}  // namespace puppetwarp
