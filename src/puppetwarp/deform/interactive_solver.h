#pragma once

#include <puppetwarp/deform/deformer.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace puppetwarp {

//! What a drag shows at one moment.
struct InteractiveFrame {
    Eigen::MatrixX2d V;                 //!< #V x 2, the best positions so far; always finite
    bool settled = false;               //!< less than a twentieth of a thousandth of the subject's size is left to go
    bool converged = false;             //!< to the tolerance of the options
    int iterations = 0;                 //!< of this call
    double energy = 0;                  //!< the method's own at V, px^2
    double max_handle_error_px = 0;     //!< against what each handle constrains
    std::vector<std::string> warnings;  //!< as of a Deformation
};

//! A deformation that follows handles while they are dragged. Remembers where it is: each call goes on from the
//! positions of the last. For `arap`, `smooth-arap` and `fold-free` the factor that steers the descent is refreshed by
//! a worker thread, so that no call waits for it; how far a call comes in its time depends on the machine, where it
//! ends does not. The other methods answer at once. For one thread at a time.
class InteractiveSolver {
public:
    //! \param worker  false: factors are refreshed by the calls themselves, when that is due; then results do not
    //! depend
    //!                on timing, as long as budgets are large.
    //! \throw InvalidInput  as `make_deformer`.
    InteractiveSolver(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig, bool worker = true);
    //! \param progress  hears of `weights`, which may take seconds; may cancel.   \throw Cancelled
    InteractiveSolver(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig, bool worker,
                      Progress& progress);
    ~InteractiveSolver();
    InteractiveSolver(const InteractiveSolver&) = delete;
    InteractiveSolver& operator=(const InteractiveSolver&) = delete;

    //! Goes on for another rig from where it is: handles were added, removed or placed anew. Points and bones cost a
    //! few solves; where vertices or regions changed, the factor is made anew. \throw InvalidInput  as `make_deformer`;
    //! nothing has changed then.
    void set_rig(const Rig& rig);
    //! \param progress  as of the constructor.   \throw Cancelled  nothing has changed then.
    void set_rig(const Rig& rig, Progress& progress);

    //! Brings the handles to where the pose has them, and the rest after them, until settled or the time is over.
    //! Called again with the same pose it goes on until converged.
    //! \param budget_ms  at least one iteration is done in any case.
    //! \throw InvalidInput  the pose does not fit the rig; the positions stay.
    InteractiveFrame advance(const Pose& pose, double budget_ms);

    //! Starts again from the way that `Deformer::deform` takes to this pose.
    //! \throw InvalidInput, Cancelled  the positions stay.
    InteractiveFrame restart(const Pose& pose, Progress& progress);

    //! By handle id, how far each point with a free angle has turned from rest since the last `restart`, whole turns
    //! counted: what a pose keeps as `turn_rad`, so that `Deformer::deform` comes to the same minimum. Radians.
    std::map<std::string, double> turns() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace puppetwarp
