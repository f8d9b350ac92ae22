#include "samples.h"

namespace samples {

const std::vector<Sample>& all_samples() {
    static const std::vector<Sample> kSamples{
        {"gingerbread", draw_gingerbread},
        {"figure", draw_figure},
        {"ring", draw_ring},
        {"tail", draw_tail},
        {"photo", draw_photo},
        {"jellyfish", draw_jellyfish},
    };
    return kSamples;
}

}  // namespace samples
