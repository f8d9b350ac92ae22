#pragma once

#include <puppetwarp/image/read.h>
#include <puppetwarp/project/puppet.h>

namespace puppetwarp {

//! A puppet's rig with its stiffness pictures loaded: their luma (BT.709, alpha ignored), stretched over the image.
//! \param width, height  of the puppet's picture, px; 0: there is none, each picture covers its own pixels.
//! \throw InvalidInput  `read_image`.
Rig load_rig(const Puppet& puppet, int width, int height, const ReadOptions& read = {});

//! The same for a mesh that was given as a file: stiffness pictures lie over the puppet's own picture where it has one.
//! \throw InvalidInput  `read_image`, `read_image_info`.
Rig load_rig_for_mesh(const Puppet& puppet);

}  // namespace puppetwarp
