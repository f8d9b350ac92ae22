#pragma once
// Private header.

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>

namespace puppetwarp {

//! For every small patch of a picture that touches a hole, a patch from around that looks like it: what the hole is
//! filled with. Sources lie no farther than the hole is deep there, so that nothing far away is copied into it.
//! The same for any number of threads.
//! Matching: Barnes et al. 2009, "PatchMatch", with candidates of the neighbours as they were before each pass.
//! Voting: Wexler et al. 2007, "Space-Time Completion of Video".
class PatchField {
public:
    static constexpr int radius = 3;  //!< of patches, px

    //! \param hole   #rows x #cols, CV_8U, not 0 where the picture is not known.
    //! \param depth  #rows x #cols, CV_32F, how far each pixel is from what is known, px; 0 there.
    //! Both must outlive it.
    PatchField(const cv::Mat& hole, const cv::Mat& depth);

    //! Begins with the nearest patches of what is known. \return false when there is none.
    bool begin();
    //! Begins with the patches of a field for the picture at half the size, which had some. \return true.
    bool begin(const PatchField& coarse);

    //! Looks for better patches: among those of neighbours, so many pixels away in each pass, and at random.
    //! \param picture          CV_32F, 1 to 4 channels, full scale 1.
    //! \param random_reach_px  how far random candidates may be from the last ones.
    //! \param seed             of the random ones.
    void improve(const cv::Mat& picture, std::span<const int> passes, int random_reach_px, std::uint32_t seed);

    //! Fills the hole of `picture` with the means of what the patches over each pixel say.
    void vote(cv::Mat& picture) const;

    //! By how much the picture beside the hole differs from what the patches that reach there say: what is missing to a
    //! filling without a seam. Means over cells of cell_px x cell_px.
    //! \param known  set to 255 for the cells that have any, CV_8U.
    cv::Mat seam(const cv::Mat& picture, int cell_px, cv::Mat& known) const;

    //! CV_16SC2, from the middle of each patch that touches the hole to that of its source.
    const cv::Mat& offsets() const { return offset_; }

    //! How much each of those patches counts, CV_32F; 0 elsewhere.
    cv::Mat votes(int channels) const;

    //! How unlike what is around them the patches over each pixel are: root of mean squares, 1 is full scale. CV_32F
    cv::Mat mismatch(int channels) const;

private:
    template <int Channels>
    class Matcher;

    bool vote_at(int x, int y, const cv::Mat& weight, const cv::Mat& picture, float* out) const;
    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < source_.cols && y < source_.rows; }
    bool is_source(int x, int y) const { return inside(x, y) && source_.ptr<std::uint8_t>(y)[x] != 0; }
    bool is_target(int x, int y) const { return inside(x, y) && target_.ptr<std::uint8_t>(y)[x] != 0; }

    const cv::Mat& hole_;
    const cv::Mat& depth_;
    cv::Mat source_;  // CV_8U: centres of patches that are known altogether
    cv::Mat target_;  // CV_8U: centres of patches that touch the hole
    cv::Mat trust_;   // CV_16S, 1 to 16: how much a pixel counts, less the deeper it is
    cv::Mat offset_;  // CV_16SC2: from each target to its source
    cv::Mat cost_;    // CV_32S: how unlike they are
};

}  // namespace puppetwarp
