/// Columns of a trace: values of its own, then the telemetry of a tick and what the law reports;
/// all or some of them.
#ifndef QUIESCE_TICK_COLUMNS_H
#define QUIESCE_TICK_COLUMNS_H

#include <optional>
#include <string>
#include <vector>

#include "board_file.h"
#include "trace.h"

namespace quiesce {

/// What the column "flags" of a trace says of a tick: bit 0 a fresh sample of the first sensor, 1
/// enable, 2 emergency stop, 3 fault reset, 4 a measured current of the first damper.
std::uint32_t traced_flags(std::uint32_t flags);

/// A column that is a word of the reply.
struct ReplyColumn {
    std::string name;
    std::size_t word; ///< of lockstep_reply_t
};

/// Telemetry, and what the law reports by its own names. board: also what the controller makes of
/// its sensors, by the names of bodies and dampers (roof_displacement_nm); null: none.
std::vector<ReplyColumn> controller_columns(std::int32_t law, const BoardFile *board);

class TickColumns {
  public:
    /// own: names of the columns before those of the controller. list: names separated by commas;
    /// all columns without it. Throws InputError, naming what there is, for a name that is none of
    /// them.
    TickColumns(std::vector<std::string> own, const std::vector<ReplyColumn> &controller,
                const std::optional<std::string> &list);

    std::vector<std::string> names() const;

    /// Appends one row. own: the values, in the order of their names.
    void put(const std::vector<double> &own, const lockstep_reply_t &reply, Trace &trace) const;

  private:
    void choose(const std::optional<std::string> &list);

    std::size_t own_count_;
    std::vector<std::string> all_names_;
    std::vector<std::size_t> words_;  ///< of the reply, for each name after the own ones
    std::vector<std::size_t> chosen_; ///< indices into all names
};

} // namespace quiesce

#endif
