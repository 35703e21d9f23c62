#include "pipeline/analysis/specimens.h"

#include <cmath>

namespace palpate::pipeline {

const char* scale_name(PoolScale scale) {
    return scale == PoolScale::linear ? "linear" : scale == PoolScale::logarithmic ? "logarithmic" : "compressibility";
}

double number_at(PoolScale scale, double x) {
    return scale == PoolScale::linear ? x : scale == PoolScale::logarithmic ? std::exp(x) : (1 - std::exp(x)) / 2;
}

}  // namespace palpate::pipeline
