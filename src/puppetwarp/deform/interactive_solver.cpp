#include <puppetwarp/deform/interactive_solver.h>

#include <puppetwarp/deform/drag.h>
#include <puppetwarp/deform/variational_problem.h>

#include <utility>

namespace puppetwarp {

// One of two: a drag of a variational method, or a deformer that answers at once.
class InteractiveSolver::Impl {
public:
    Impl(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig, bool worker, Progress& progress)
        : options_(options), mesh_(mesh), rig_(rig) {
        if (is_variational(options.method)) {
            require_sound(mesh, "mesh");
            require_sound(rig);
            drag_ = std::make_unique<Drag>(std::make_shared<VariationalProblem>(options, mesh, rig), worker);
        } else {
            deformer_ = make_deformer(options, mesh, rig, progress);
        }
    }

    void set_rig(const Rig& rig, Progress& progress) {
        if (drag_) {
            require_sound(rig);
            drag_->set_problem(std::make_shared<VariationalProblem>(drag_->problem(), rig));
        } else {
            std::unique_ptr<Deformer> next = deformer_->with_rig(rig);
            deformer_ = next ? std::move(next) : make_deformer(options_, mesh_, rig, progress);
        }
        rig_ = rig;
    }

    InteractiveFrame advance(const Pose& pose, double budget_ms) {
        return drag_ ? with_warnings(drag_->advance(pose, budget_ms)) : answer(pose);
    }

    InteractiveFrame restart(const Pose& pose, Progress& progress) {
        return drag_ ? with_warnings(drag_->restart(pose, progress)) : answer(pose);
    }

    std::map<std::string, double> turns() const {
        std::map<std::string, double> turns;
        if (!drag_) return turns;
        const Binding& binding = drag_->problem().binding();
        for (std::size_t h = 0; h < binding.holds.size(); ++h) {
            if (binding.holds[h].turn.empty()) continue;
            turns[rig_.handles[static_cast<std::size_t>(binding.holds[h].handle)].id] = drag_->turn_rad(h);
        }
        return turns;
    }

private:
    InteractiveFrame with_warnings(InteractiveFrame frame) const {
        frame.warnings = drag_->problem().binding().warnings;
        return frame;
    }

    InteractiveFrame answer(const Pose& pose) const {
        Progress progress;
        Deformation deformation = deformer_->deform(pose, nullptr, progress);
        return {std::move(deformation.V),
                true,
                deformation.converged,
                deformation.iterations,
                deformation.energy,
                deformation.max_handle_error_px,
                std::move(deformation.warnings)};
    }

    MethodOptions options_;
    TriangleMesh mesh_;
    Rig rig_;
    std::unique_ptr<Drag> drag_;
    std::unique_ptr<Deformer> deformer_;
};

InteractiveSolver::InteractiveSolver(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                                     bool worker) {
    Progress nobody;
    impl_ = std::make_unique<Impl>(options, mesh, rig, worker, nobody);
}
InteractiveSolver::InteractiveSolver(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                                     bool worker, Progress& progress)
    : impl_(std::make_unique<Impl>(options, mesh, rig, worker, progress)) {}
InteractiveSolver::~InteractiveSolver() = default;

void InteractiveSolver::set_rig(const Rig& rig) {
    Progress nobody;
    impl_->set_rig(rig, nobody);
}

void InteractiveSolver::set_rig(const Rig& rig, Progress& progress) {
    impl_->set_rig(rig, progress);
}

InteractiveFrame InteractiveSolver::advance(const Pose& pose, double budget_ms) {
    return impl_->advance(pose, budget_ms);
}

InteractiveFrame InteractiveSolver::restart(const Pose& pose, Progress& progress) {
    return impl_->restart(pose, progress);
}

std::map<std::string, double> InteractiveSolver::turns() const {
    return impl_->turns();
}

}  // namespace puppetwarp
