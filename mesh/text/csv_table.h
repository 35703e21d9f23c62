#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::mesh {

/// A tidy CSV file: a header row, then numbers, and names in those columns that hold some; '#' starts a comment, blank
/// lines are skipped. An empty cell is NaN, and so is "nan" or "NA". Spaces round a cell and a byte-order mark are
/// ignored; both line ends are read.
///
/// Cells are separated by commas, or as spreadsheets of other countries do: by semicolons or tabs, whichever the header
/// holds; numbers may then have a decimal comma. Columns are named in either case, and may tell a unit: "X [mm]".
class CsvTable {
public:
    /// @param names those of the required columns whose cells are text
    /// @throws IoError, InvalidInput: no header, a cell that is no number, too many or few cells in a row, a column
    /// that is missing (`required`) or that is neither required nor `optional`, a column named twice.
    CsvTable(const std::filesystem::path& file, const std::vector<std::string>& required,
             const std::vector<std::string>& optional = {}, const std::vector<std::string>& names = {});

    int rows() const { return static_cast<int>(lines_.size()); }
    bool has(const std::string& column) const;
    /// @throws InvalidInput where the header tells another unit for one of these columns. @param told where that unit
    /// is said, for the message
    void require_unit(const std::vector<std::string>& columns, const std::string& unit, const std::string& told) const;
    /// NaN where the cell is empty or the (optional) column absent.
    double at(int row, const std::string& column) const;
    /// @throws InvalidInput naming file, line and column where the cell is empty or not finite.
    double number(int row, const std::string& column) const;
    /// @throws InvalidInput where it is not a whole number that fits.
    int integer(int row, const std::string& column) const;
    /// The text of a column of names; "" where the cell is empty.
    const std::string& text(int row, const std::string& column) const;
    /// The same. @throws InvalidInput where the cell is empty.
    const std::string& name(int row, const std::string& column) const;
    /// "probes.csv, line 12", to begin a message with.
    std::string where(int row) const;

private:
    std::filesystem::path file_;
    std::vector<std::string> columns_;            // in small letters, without units
    std::vector<std::string> units_;              // of the columns, as the header tells them; "": it does not
    std::vector<int> lines_;                      // line of the file behind each row
    std::vector<std::vector<double>> cells_;      // (rows x columns); NaN in columns of names
    std::vector<std::vector<std::string>> text_;  // (rows x columns); empty in columns of numbers
};

}  // namespace palpate::mesh
