#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace puppetwarp {

//! The pictures in a folder and the folders below it.
struct FolderListing {
    std::vector<std::string> pictures;  //!< paths in the folder, with `/`, in the order of their bytes
    std::vector<std::string> loops;     //!< links to a folder that they lie in, which are not followed
};

//! Pictures are known by the ends of their names (png, jpg, tif, webp, exr, ...), whatever they are: a link that leads
//! nowhere, a pipe, or a picture of a format that cannot be read (bmp, tga, jxl) is listed, and will be complained of
//! when it is read. Links to folders are followed.
//! \throw InvalidInput  a folder cannot be read.
FolderListing list_pictures(const std::filesystem::path& folder);

}  // namespace puppetwarp
