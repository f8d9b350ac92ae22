#pragma once

#include <puppetwarp/base/progress.h>
#include <puppetwarp/weights/weights.h>

#include <filesystem>

namespace puppetwarp {

//! Where the weights of a puppet file are kept from run to run: `NAME.puppet.weights` beside `NAME.puppet.json`.
std::filesystem::path weights_cache_path(const std::filesystem::path& puppet_file);

//! `compute_weights`, of kinds that take long from what an earlier run kept: the file is used only when its key, a
//! SHA-256 of everything that the weights depend on, is the same, and when it is whole; else they are computed and the
//! file is replaced. The result is the same to the bit either way. A file that cannot be read or written is passed
//! over in silence, as if there was none: nothing is lost with it.
//! \param file  of `weights_cache_path`, or empty: nothing is kept.
//! \throw InvalidInput, Cancelled  as `compute_weights`.
Weights cached_weights(const TriangleMesh& mesh, const Rig& rig, const WeightOptions& options,
                       const std::filesystem::path& file, Progress& progress);

}  // namespace puppetwarp
