#pragma once

#include <puppetwarp/cutout/cutout.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/project/puppet.h>

#include <Eigen/Core>

#include <filesystem>
#include <optional>

namespace puppetwarp {

//! How large the picture is that a puppet is drawn with, and the one whose pixels the puppet's coordinates count.
struct SourceSize {
    int width = 0;  //!< of the picture that is drawn
    int height = 0;
    int rig_width = 0;  //!< of the picture that the puppet was made on
    int rig_height = 0;

    //! Whether both sides grow by the same factor, within the rounding to whole pixels.
    bool is_same_shape() const;
    bool is_same() const { return width == rig_width && height == rig_height; }
    //! Pixels of the drawn picture for one of the puppet's, along x and y: equal but for the rounding of sizes.
    Eigen::RowVector2d resolution() const {
        return {static_cast<double>(width) / rig_width, static_cast<double>(height) / rig_height};
    }
};

//! Reads the headers of the puppet's picture and of `other`, which is drawn instead. A puppet that names no picture was
//! made on `other`.
//! \param other  empty: the puppet's own picture is drawn.
//! \throw InvalidInput  `read_image_info`, no picture at all, pictures of different shapes.
SourceSize source_size(const Puppet& puppet, const std::filesystem::path& other, const ReadOptions& read);

//! The same for a source that is drawn whole whatever its pixels are, so that its mesh need not wait for them; none for
//! others, and where something is wrong, which reading it will say.
std::optional<SourceSize> size_of_whole(const Puppet& puppet, const std::filesystem::path& other,
                                        const ReadOptions& read);

//! What the puppet says of its cutout, with the mask read.
CutoutOptions cutout_options(const Puppet& puppet, const ReadOptions& read);

//! `cut_out_subject` of a picture at another resolution: polygons are scaled, and a mask of the rig's size too.
Cutout cut_out_at(const SourceSize& size, const Puppet& puppet, const Image& image, const ReadOptions& read);

//! The cutout at the rig's resolution, for its outline: wherever it had coverage, it has some.
Cutout cutout_for_rig(const Cutout& cutout, const SourceSize& size);

}  // namespace puppetwarp
