#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/diff/compare.h>

#include <filesystem>
#include <string>

namespace puppetwarp {

//! How a picture is held against its golden picture, the one that a person looked at and accepted.
struct GoldenOptions {
    CompareOptions compare = {};  //!< how much they may differ; by default not at all
    //! Of golden paths that are relative. Empty: what PUPPETWARP_GOLDEN_FOLDER in the environment says, else the
    //! `usual_folder` of `check_golden`, else the working folder.
    std::filesystem::path golden_folder = {};
    //! Where a failure leaves its pictures, made when needed. Empty: what PUPPETWARP_IMAGE_TEST_OUTPUT in the
    //! environment says, else `image-tests` in the working folder.
    std::filesystem::path output_folder = {};
};

//! What came of it.
struct GoldenResult {
    bool passed = false;
    bool updated = false;  //!< the golden picture was written; then `passed` too
    std::string message;   //!< why not, which files show it, how to accept; or which file was written. No final newline
};

//! Compares a picture with its golden picture. Where they differ, `NAME.expected.EXT`, `NAME.actual.EXT` and
//! `NAME.heatmap.png` are written to the output folder, in the subfolder that the golden path names; without a heat map
//! where the sizes or the channels differ, without the expected picture where there is none. A golden picture that
//! is missing or cannot be read is a failure.
//!
//! With UPDATE_GOLDENS=1 in the environment a picture that would fail becomes the golden one instead, whole or not at
//! all; one that passes is left as it is, so that version control shows what changed. A file format that does not give
//! the picture back within `options` is a failure then.
//! \param golden        file in a format without loss that can be written (.png, .tif, .exr, ...).
//! \param usual_folder  see `GoldenOptions::golden_folder`.
//! Never throws InvalidInput or MachineFault: they become the message of a failure.
GoldenResult check_golden(const Image& actual, const std::filesystem::path& golden, const GoldenOptions& options = {},
                          const std::filesystem::path& usual_folder = {});

}  // namespace puppetwarp
