/// [parameters] of the configuration: NAME = VALUE, or the label of a choice.
#ifndef QUIESCED_PARAMETER_SECTION_H
#define QUIESCED_PARAMETER_SECTION_H

#include "firmware.h"
#include "section.h"

namespace quiesced {

/// Defaults, then what the section says; each value and all of them together are checked. With a
/// board, parameters that it takes the place of are refused.
quiesce_params_t read_parameters(Section &section, bool has_board);

} // namespace quiesced

#endif
