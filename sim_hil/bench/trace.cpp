#include "trace.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "input_error.h"
#include "json.h"

namespace quiesce {

void Trace::write(const std::string &file) const {
    // A device or a pipe takes what is written and stays what it is.
    const bool is_replaced =
        !std::filesystem::exists(file) || std::filesystem::is_regular_file(file);
    const std::string unfinished = is_replaced ? file + ".part" : file;
    std::ofstream out(unfinished, std::ios::binary);
    const Json head = {{"columns", columns_}, {"rows", values_.size() / columns_.size()}};
    out << head.dump() << '\n';
    out.write(reinterpret_cast<const char *>(values_.data()),
              static_cast<std::streamsize>(values_.size() * sizeof(double)));
    out.close();
    const bool is_there =
        out && (!is_replaced || std::rename(unfinished.c_str(), file.c_str()) == 0);
    if (!is_there) {
        if (is_replaced) {
            std::remove(unfinished.c_str());
        }
        throw InputError("--trace " + file + ": cannot write the file; check folder and space");
    }
}

} // namespace quiesce
