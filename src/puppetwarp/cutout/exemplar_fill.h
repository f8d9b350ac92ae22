#pragma once
// Private header.

#include <puppetwarp/base/progress.h>
#include <puppetwarp/cutout/enlarged.h>

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! What a hole was filled with, so that a larger picture can be filled with the same. Empty when no patch was found.
struct HoleFilling {
    cv::Mat offset;  //!< `PatchField::offsets`
    cv::Mat weight;  //!< `PatchField::votes`
    // What all patches together lack, and how well they fit and what stands in where they do not, in pictures that are
    // 2^halvings times smaller.
    cv::Mat missing;
    int seam_halvings = 0;
    cv::Mat mismatch;
    cv::Mat smooth;
    int halvings = 0;

    bool empty() const { return offset.empty(); }
};

//! Fills the hole of a picture with what is around it: with patches that go on with what ends there, from coarse
//! pictures to fine, and with a membrane where none fits.
//!
//! \param picture   #rows x #cols, CV_32F, 1 to 4 channels of full scale 1; alpha premultiplied. Changed in the hole
//!                  only.
//! \param hole      #rows x #cols, CV_8U, not 0 where the picture is not known; somewhere it must be.
//! \param progress  hears of the stage `background`; may cancel.
HoleFilling fill_hole(cv::Mat& picture, const cv::Mat& hole, Progress& progress);

//! Takes seams away from what patches say, and fades to the substitute where they do not fit.
class FillingFinish {
public:
    //! \param halvings  of the picture that was filled, from the one that is. Keeps references into `filling`.
    FillingFinish(const HoleFilling& filling, int halvings);
    void apply(int x, int y, int channels, float* pixel) const;

private:
    Enlarged smooth_, mismatch_, missing_;
};

}  // namespace puppetwarp
