#include <puppetwarp/warp/sampling.h>

puppetwarp::detail::RunSampler puppetwarp::detail::find_avx2_sampler(const PixelFormat&, Interpolation) {
    return nullptr;
}
