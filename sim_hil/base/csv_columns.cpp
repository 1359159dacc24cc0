#include "csv_columns.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "input_error.h"

namespace quiesce {

namespace {

[[noreturn]] void fail(const std::string &file, std::size_t line, const std::string &message) {
    throw InputError(file + ":" + std::to_string(line) + ": " + message);
}

std::string trimmed(const std::string &text) {
    const char *const blank = " \t\r";
    const std::size_t first = text.find_first_not_of(blank);
    return first == std::string::npos
               ? ""
               : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string> split(const std::string &line) {
    std::vector<std::string> cells;
    std::size_t from = 0;
    for (std::size_t comma = 0; comma != std::string::npos; from = comma + 1) {
        comma = line.find(',', from);
        cells.push_back(trimmed(line.substr(from, comma - from)));
    }
    return cells;
}

std::string without_byte_order_mark(const std::string &line) {
    return line.rfind("\xEF\xBB\xBF", 0) == 0 ? line.substr(3) : line;
}

[[noreturn]] void fail_no_column(const std::string &file, const std::string &name,
                                 const std::vector<std::string> &header) {
    std::string message = "no column '" + name + "'; there are: ";
    for (std::size_t i = 0; i < header.size(); ++i) {
        message += i == 0 ? "" : ", ";
        message += header[i];
    }
    fail(file, 1, message);
}

/// Where each name stands in the header.
std::vector<std::size_t> positions(const std::string &file, const std::vector<std::string> &header,
                                   const std::vector<std::string> &names) {
    std::vector<std::size_t> out;
    for (const std::string &name : names) {
        const auto found = std::find(header.begin(), header.end(), name);
        if (found == header.end()) {
            fail_no_column(file, name, header);
        }
        out.push_back(static_cast<std::size_t>(found - header.begin()));
    }
    return out;
}

double number(const std::string &file, std::size_t line, const std::string &name,
              const std::string &cell) {
    double value = 0.0;
    const char *const end = cell.data() + cell.size();
    const auto [stop, error] = std::from_chars(cell.data(), end, value);
    if (error != std::errc{} || stop != end || !std::isfinite(value)) {
        fail(file, line, name + ": expected a finite number, found '" + cell + "'");
    }
    return value;
}

} // namespace

std::vector<CsvRow> read_csv_columns(const std::string &file,
                                     const std::vector<std::string> &names) {
    std::ifstream in(file);
    std::string text;
    if (std::filesystem::is_directory(file) || !std::getline(in, text)) {
        fail(file, 1, "cannot be read, or is empty; expected a CSV file with a header line");
    }
    const std::vector<std::string> header = split(without_byte_order_mark(text));
    const std::vector<std::size_t> columns = positions(file, header, names);
    std::vector<CsvRow> rows;
    for (std::size_t line = 2; std::getline(in, text); ++line) {
        if (trimmed(text).empty()) {
            continue;
        }
        const std::vector<std::string> cells = split(text);
        CsvRow row{line, {}};
        for (std::size_t i = 0; i < columns.size(); ++i) {
            row.values.push_back(
                number(file, line, names[i], columns[i] < cells.size() ? cells[columns[i]] : ""));
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

std::vector<CsvRow> read_csv_numbers(const std::string &file) {
    std::ifstream in(file);
    std::string text;
    std::vector<CsvRow> rows;
    for (std::size_t line = 1; !std::filesystem::is_directory(file) && std::getline(in, text);
         ++line) {
        const std::string content = line == 1 ? without_byte_order_mark(text) : text;
        if (trimmed(content).empty()) {
            continue;
        }
        CsvRow row{line, {}};
        for (const std::string &cell : split(content)) {
            row.values.push_back(
                number(file, line, "column " + std::to_string(row.values.size() + 1), cell));
        }
        rows.push_back(std::move(row));
    }
    if (rows.empty()) {
        fail(file, 1, "cannot be read, or is empty; expected lines of numbers");
    }
    return rows;
}

} // namespace quiesce
