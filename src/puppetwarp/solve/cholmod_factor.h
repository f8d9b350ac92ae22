#pragma once
// Private header of solve/: CHOLMOD's structures with an owner.

#include <puppetwarp/base/errors.h>

#include <Eigen/SparseCore>

#include <cholmod.h>

#include <string>

namespace puppetwarp::detail {

//! A CHOLMOD factor together with the workspace that CHOLMOD wants beside it. Simplicial: no BLAS is called, and the
//! bits do not depend on the machine's.
struct CholmodFactor {
    CholmodFactor() {
        cholmod_start(&common);
        common.print = 0;
        common.supernodal = CHOLMOD_SIMPLICIAL;
        common.final_ll = 1;
        common.quick_return_if_not_posdef = 1;
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_AMD;
    }
    ~CholmodFactor() {
        cholmod_free_factor(&factor, &common);
        cholmod_finish(&common);
    }
    CholmodFactor(const CholmodFactor&) = delete;
    CholmodFactor& operator=(const CholmodFactor&) = delete;

    void require_success() const {
        if (common.status >= CHOLMOD_OK && factor != nullptr) return;
        throw MachineFault("sparse factorisation",
                           common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE
                               ? "out of memory"
                               : "failed with CHOLMOD status " + std::to_string(common.status),
                           "use a coarser mesh");
    }

    cholmod_common common{};
    cholmod_factor* factor = nullptr;
};

//! CHOLMOD's view of the lower triangle of an Eigen matrix, compressed; CHOLMOD only reads it.
cholmod_sparse view_of(const Eigen::SparseMatrix<double>& A);

}  // namespace puppetwarp::detail
