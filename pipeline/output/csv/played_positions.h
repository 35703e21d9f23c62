#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "pipeline/analysis/forecast/forecast.h"

namespace palpate::pipeline {

/// Where a played model's markers stand: probe,time,marker,x,y,z,ux,uy,uz,sd,within_95 [mm]; `sd` is of a coordinate
/// and within_95 the half width of its 95 % interval, both empty where there is no posterior. A marker moves as the
/// skin nearest to it; without markers every vertex of the skin is one, numbered from 0.
std::string played_positions_csv(const skeleton::Model& model, const std::vector<identify::LoadState>& states,
                                 const std::vector<Forecast>& forecasts, const std::vector<identify::Marker>& markers);

}  // namespace palpate::pipeline
