#include "trace.h"

#include <cstdio>
#include <fstream>

#include "input_error.h"
#include "json.h"
#include "reply_fields.h"

namespace quiesce {

std::vector<std::string> with_telemetry_columns(std::vector<std::string> names) {
    for (const WordField &field : telemetry_fields()) {
        names.emplace_back(field.name);
    }
    return names;
}

double telemetry_value(const quiesce_telemetry_t &telemetry, std::size_t index) {
    const std::uint32_t word = word_of(telemetry, index);
    return telemetry_fields()[index].is_signed
               ? static_cast<double>(static_cast<std::int32_t>(word))
               : static_cast<double>(word);
}

void Trace::put_telemetry(const quiesce_telemetry_t &telemetry) {
    for (std::size_t i = 0; i < telemetry_fields().size(); ++i) {
        put(telemetry_value(telemetry, i));
    }
}

void Trace::write(const std::string &file) const {
    const std::string unfinished = file + ".part";
    std::ofstream out(unfinished, std::ios::binary);
    const Json head = {{"columns", columns_}, {"rows", values_.size() / columns_.size()}};
    out << head.dump() << '\n';
    out.write(reinterpret_cast<const char *>(values_.data()),
              static_cast<std::streamsize>(values_.size() * sizeof(double)));
    out.close();
    if (!out || std::rename(unfinished.c_str(), file.c_str()) != 0) {
        std::remove(unfinished.c_str());
        throw InputError("--trace " + file + ": cannot write the file; check folder and space");
    }
}

} // namespace quiesce
