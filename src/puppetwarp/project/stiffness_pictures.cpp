#include <puppetwarp/project/stiffness_pictures.h>

#include <opencv2/core.hpp>

#include <algorithm>

namespace puppetwarp {

namespace {

// #rows x #cols of CV_32FC1 in [0, 1].
cv::Mat luma_of(const Image& image) {
    cv::Mat values, grey;
    image.pixels.convertTo(values, CV_32F, 1 / image.full_value());
    cv::patchNaNs(values, 0);
    values = cv::max(cv::min(values, 1), 0);
    if (image.pixels.channels() <= 2) {
        cv::extractChannel(values, grey, 0);
    } else {
        const bool alpha = image.has_alpha();
        const cv::Mat weights = alpha ? cv::Mat(cv::Matx14f(0.2126F, 0.7152F, 0.0722F, 0))
                                      : cv::Mat(cv::Matx13f(0.2126F, 0.7152F, 0.0722F));
        cv::transform(values, grey, weights);
    }
    return grey;
}

}  // namespace

Rig load_rig(const Puppet& puppet, int width, int height, const ReadOptions& read) {
    Rig rig = puppet.rig;
    for (Stiffness& stiffness : rig.stiffness) {
        auto* picture = std::get_if<StiffnessPicture>(&stiffness);
        if (picture == nullptr) continue;
        picture->grey = luma_of(read_image(resolve(puppet, picture->path), read));
        picture->width_px = width > 0 ? width : picture->grey.cols;
        picture->height_px = height > 0 ? height : picture->grey.rows;
    }
    return rig;
}

Rig load_rig_for_mesh(const Puppet& puppet) {
    const bool pictures = std::any_of(puppet.rig.stiffness.begin(), puppet.rig.stiffness.end(),
                                      [](const auto& each) { return std::holds_alternative<StiffnessPicture>(each); });
    if (!pictures || puppet.image.empty()) return load_rig(puppet, 0, 0);
    const ImageInfo image = read_image_info(resolve(puppet, puppet.image));
    return load_rig(puppet, image.width, image.height);
}

}  // namespace puppetwarp
