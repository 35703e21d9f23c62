#pragma once

#include <Eigen/Core>

namespace palpate::fem {

struct NewtonOptions {
    double tolerance = 1e-8;  // of the residual's norm, as a share of the load's, > 0
    int iterations = 60;      // at one load, >= 1
    int load_steps = 16;      // parts that the load may be put on in where it fails at once; 0: from the start only
    void validate() const;    // @throws InvalidInput naming option, value and bound
};

struct BodyEquilibrium {
    Eigen::VectorXd u;       // displacement of the nodes (3n) [mm]
    int iterations = 0;      // steps, in all
    int factorisations = 0;  // of the tangent, in all
    double residual = 0;     // norm of the net force left at free nodes [N]
};

}  // namespace palpate::fem
