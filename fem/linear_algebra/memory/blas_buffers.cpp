#include "fem/linear_algebra/memory/blas_buffers.h"

#include <cblas.h>

#include <Eigen/Core>
#include <barrier>
#include <thread>
#include <vector>

namespace palpate::fem {

void take_blas_buffers(int threads) {
    openblas_set_num_threads(1);
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(512, 512);  // long enough that all threads are in it at once
    std::barrier all_there(threads);
    std::vector<std::jthread> workers;
    workers.reserve(threads);
    for (int i = 0; i < threads; ++i)
        workers.emplace_back([&A, &all_there] {
            Eigen::MatrixXd B(A.rows(), A.cols());
            const auto n = static_cast<int>(A.rows());
            all_there.arrive_and_wait();
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, n, n, n, 1.0, A.data(), n, A.data(), n, 0.0,
                        B.data(), n);
        });
}

}  // namespace palpate::fem
