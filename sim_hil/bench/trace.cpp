#include "trace.h"

#include <cstdio>
#include <fstream>

#include "input_error.h"
#include "json.h"

namespace quiesce {

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
