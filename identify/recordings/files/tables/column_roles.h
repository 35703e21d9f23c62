#pragma once

#include <array>
#include <string>
#include <vector>

#include "identify/recordings/files/text/number_table.h"

namespace palpate::identify {

/// The columns of a point; -1: there is none.
struct PointColumns {
    std::string name;
    std::array<int, 3> at{-1, -1, -1};
    std::array<int, 3> displacement{-1, -1, -1};
};

/// What the columns of a table with a row for each instant are.
struct ColumnRoles {
    int time = -1;
    int frame = -1;  // numbers the rows
    std::vector<PointColumns> points;
    std::vector<int> channels;
    std::vector<std::string> notes;  // what was concluded from numbers alone
};

/// By the names of the columns; without names by their numbers.
ColumnRoles roles_of(const NumberTable& table);

/// "M1_x", "X2", "LASI:Z", "tip y": the point's name and the coordinate, 0 to 2; -1: the name is none of a coordinate.
struct CoordinateName {
    std::string point;
    int axis = -1;
};
CoordinateName coordinate_in(const std::string& name);

/// Do the values rise from row to row by the same step, as those of a clock or a counter do?
bool is_steady(const Eigen::VectorXd& values);

}  // namespace palpate::identify
