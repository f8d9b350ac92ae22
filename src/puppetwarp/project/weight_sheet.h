#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/weights/weights.h>

#include <cstdint>
#include <string>

namespace puppetwarp {

struct WeightSheetOptions {
    int columns = 0;                        //!< at most 64; 0: as many as make a sheet of about 3 to 2
    int cell_px = 320;                      //!< longer side of each heat map, 120 to 2000
    std::int64_t max_pixels = 200'000'000;  //!< of the sheet; more is refused
};

//! A sheet of heat maps, one a column of weights, each with iso-lines, its handle or corner of a cage in yellow, the
//! others in grey, its name and its range; a legend below. Of complex weights the real part. The same bytes each time.
//! \param title  above all maps.
//! \return 8-bit RGB.
//! \throw InvalidInput  options out of range, a sheet that is too large.   \throw Cancelled
Image draw_weight_sheet(const TriangleMesh& mesh, const Rig& rig, const Weights& weights, const std::string& title,
                        const WeightSheetOptions& options, Progress& progress);

}  // namespace puppetwarp
