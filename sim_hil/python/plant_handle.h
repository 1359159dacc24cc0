/// What the files of the plant's C library share.
#ifndef QUIESCE_PLANT_HANDLE_H
#define QUIESCE_PLANT_HANDLE_H

#include <cstdio>
#include <exception>

#include "plant_library.h"
#include "plant_model.h"

struct quiesce_plant {
    quiesce::PlantModel model;
};

namespace quiesce {

/// Runs work; an exception becomes its text in error. Returns 0, or 1 after an exception.
template <typename Work>
int guarded(Work &&work, char *error, std::size_t error_size) {
    try {
        work();
        return 0;
    } catch (const std::exception &caught) {
        std::snprintf(error, error_size, "%s", caught.what());
    } catch (...) {
        std::snprintf(error, error_size, "unknown failure");
    }
    return 1;
}

} // namespace quiesce

#endif
