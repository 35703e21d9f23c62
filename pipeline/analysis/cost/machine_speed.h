#pragma once

namespace palpate::pipeline {

/// How fast one core is, against the one on which the rates of `cost.cpp` were measured: a factorisation and a
/// sort, some tenths of a second in all.
double machine_speed();

}  // namespace palpate::pipeline
