#pragma once

#include <puppetwarp/base/progress.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/warp/displacement.h>

#include <filesystem>

namespace puppetwarp {

// Displacement maps in files that compositing programs read: an ST map of 32-bit floats.
//
//   R  s = x / width of the source    of the place that a pixel shows; the centre of the source's pixel (i, j) has
//   G  t = 1 - y / height             s = (i + 0.5) / width, t = 1 - (j + 0.5) / height
//   B  1 where something is shown, else 0 (as in the UV pass of renderers)
//   A  how much of it: 1, or what a cutout left that is not the picture's own alpha; the others are not multiplied by
//   it
//
// Where nothing is shown all are 0. A TIFF holds these four channels and nothing of where its canvas lies. An EXR also
// has the displacement itself, in pixels of the source, which keeps more digits:
//
//   displacement.x  x of the place less the pixel's own, to the right
//   displacement.y  likewise upwards, as compositing programs count
//
// its display window is the source's picture, its data window the canvas, both in pixels of the output (rows count
// downwards in EXR too), and the numbers `puppetwarp:sourceWidth`, `puppetwarp:sourceHeight` and `puppetwarp:scale`
// (pixels of the output for one of the source) say what a pixel is. s and t are off by at most 2^-25, a place by 2^-25
// of the source's width or height: 2.4e-4 px for 8000 pixels.

//! \throw InvalidInput  a file that is neither .exr nor .tif or .tiff, or a stream.
void require_displacement_name(const std::filesystem::path& path);

//! Writes a map as EXR or TIFF by the extension, whole or not at all; it is made while it is written.
//! \param options  `compression` alone counts.
//! \throw InvalidInput  `require_displacement_name`, folder missing or read-only.  \throw MachineFault  disk full.
void write_displacement(const DisplacementRows& rows, const std::filesystem::path& path, const WriteOptions& options,
                        Progress& progress);
void write_displacement(const DisplacementMap& map, const std::filesystem::path& path,
                        const WriteOptions& options = {});

//! A map from a file.
struct StoredDisplacement {
    DisplacementMap map;
    bool knows_source = false;  //!< the file says what picture it was made for; else it is taken for the one at hand
};

//! Reads a map of this or another program: an EXR with channels R and G, or any picture of 16 or 32 bits with red and
//! green, of any size. Where `displacement.x` and `displacement.y` agree with them they add their digits; elsewhere R
//! and G decide. Pixels whose alpha is 0 show nothing, but for files whose alpha is 0 everywhere; nor do numbers that
//! are not finite. Of float maps without displacements, places nearer than 2^-23 of the source's size to a pixel's
//! centre are taken for the centre. \param width,height  of the picture that is to be drawn: of the source, where the
//! file does not know. \throw InvalidInput  `read_image`; no R and G; 8 bits.
StoredDisplacement read_displacement(const std::filesystem::path& path, int width, int height,
                                     const ReadOptions& options = {});

}  // namespace puppetwarp
