#include "board_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "board_keys.h"
#include "identifier.h"
#include "toml_table.h"

namespace quiesce {

namespace {

using Names = std::vector<std::string>;

/// Most that a scale may change when it is rounded to a whole thousandth.
constexpr double kScaleError = 1e-3;

// Names

/// Appends a name that must be another than those before it.
void add_name(const TomlTable &table, const std::string &key, const std::string &name,
              Names &names) {
    require_identifier(table, key, name);
    if (std::find(names.begin(), names.end(), name) != names.end()) {
        table.fail(key, "expected names that differ, found '" + name + "' twice");
    }
    names.push_back(name);
}

Names read_bodies(TomlTable &root) {
    Names bodies;
    for (const std::string &name : root.texts("bodies")) {
        add_name(root, "bodies", name, bodies);
        if (name == kGround) {
            root.fail("bodies", "'ground' is always there and not one of them");
        }
    }
    return bodies;
}

// They have columns of their own in traces: a body and a damper of one name would share them.
void require_other_names(const std::vector<TomlTable> &tables, const Names &names,
                         const Names &bodies) {
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (std::find(bodies.begin(), bodies.end(), names[i]) != bodies.end()) {
            tables[i].fail("name", "a body has the name '" + names[i] + "' already");
        }
    }
}

Names read_names(std::vector<TomlTable> &tables) {
    Names names;
    for (TomlTable &table : tables) {
        add_name(table, "name", table.text("name"), names);
    }
    return names;
}

/// The number of one of these names.
std::int32_t number_of(TomlTable &table, const std::string &key, const Names &names) {
    const std::string name = table.choice(key, names);
    return static_cast<std::int32_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

// Counts

struct Count {
    const char *key, *one, *many;
    std::int32_t quiesce_board_t::*field;
};

void require_count(const TomlTable &root, const Count &count, std::size_t found) {
    const FieldRange range = range_of(count.field);
    const auto most = static_cast<std::size_t>(range.max);
    if (found >= 1 && found <= most) {
        return;
    }
    const std::string served = most == 1 ? std::string("1 ") + count.one
                                         : "1 .. " + std::to_string(most) + " " + count.many;
    root.fail(count.key, "this build serves " + served + ", found " + std::to_string(found));
}

void require_counts(const TomlTable &root, const BoardFile &file) {
    require_count(root, {"bodies", "body", "bodies", &quiesce_board_t::bodies}, file.bodies.size());
    require_count(root, {"sensor", "sensor", "sensors", &quiesce_board_t::sensors},
                  file.sensors.size());
    require_count(root, {"damper", "damper", "dampers", &quiesce_board_t::dampers},
                  file.dampers.size());
}

// Numbers

template <class Part>
void read_numbers(TomlTable &table, const std::vector<NumberKey<Part>> &keys, Part &part) {
    for (const NumberKey<Part> &key : keys) {
        const FieldRange range = range_of(key.field);
        const std::int64_t value =
            key.is_required ? table.integer(key.key, range.min, range.max)
                            : table.integer(key.key, range.min, range.max, part.*key.field);
        part.*key.field = static_cast<std::int32_t>(value);
    }
}

void refuse_other_scales(const TomlTable &table, const Sense &sense) {
    for (const Sense &other : senses()) {
        if (std::string(other.scale_key) != sense.scale_key && table.has(other.scale_key)) {
            table.fail(other.scale_key, std::string("expected ") + sense.scale_key + ": " +
                                            sense.name + " is in " + sense.unit);
        }
    }
}

std::int32_t read_scale(TomlTable &table, const Sense &sense) {
    const FieldRange range = range_of(&quiesce_board_sensor_t::scale);
    const std::string unit = std::string(sense.unit) + " a count";
    refuse_other_scales(table, sense);
    const double scale =
        kScalesPerUnit * table.number(sense.scale_key, {range.min / kScalesPerUnit,
                                                        range.max / kScalesPerUnit, unit.c_str()});
    const double whole = std::round(scale);
    if (std::fabs(whole - scale) > kScaleError * scale) {
        table.fail(sense.scale_key, "expected a multiple of 0.001 within 0.1 %");
    }
    return static_cast<std::int32_t>(whole);
}

// Sensors

std::int32_t read_place(TomlTable &table, const Sense &sense, const BoardFile &file) {
    if (sense.owner == Owner::Board) {
        if (table.has("of")) {
            table.fail("of", std::string(sense.name) + " is of no body or damper; leave it out");
        }
        return 0;
    }
    return number_of(table, "of", sense.owner == Owner::Body ? file.bodies : file.dampers);
}

std::int32_t read_axis(TomlTable &table, std::int32_t sense, std::int32_t fallback) {
    if (!table.has("axis")) {
        return fallback;
    }
    if (sense != QUIESCE_SENSE_ACCEL) {
        table.fail("axis", "is of accelerometers only; leave it out");
    }
    return number_of(table, "axis", axes());
}

Names sense_names() {
    Names names;
    for (const Sense &sense : senses()) {
        names.emplace_back(sense.name);
    }
    return names;
}

void read_sensor(TomlTable &table, const BoardFile &file, quiesce_board_sensor_t &sensor) {
    sensor.sense = number_of(table, "measures", sense_names());
    const Sense &sense = senses()[static_cast<std::size_t>(sensor.sense)];
    sensor.at = read_place(table, sense, file);
    sensor.axis = read_axis(table, sensor.sense, sensor.axis);
    sensor.scale = read_scale(table, sense);
    read_numbers(table, sensor_keys(), sensor);
    table.reject_unknown_keys();
}

// Dampers

void read_ends(TomlTable &table, const Names &bodies, quiesce_board_damper_t &damper) {
    Names ends = bodies;
    ends.emplace_back(kGround);
    damper.end_a = number_of(table, "end_a", bodies);
    damper.end_b = number_of(table, "end_b", ends);
    if (damper.end_b == static_cast<std::int32_t>(bodies.size())) {
        damper.end_b = QUIESCE_GROUND;
    }
}

void read_damper(TomlTable &table, const Names &bodies, quiesce_board_damper_t &damper) {
    read_ends(table, bodies, damper);
    read_numbers(table, damper_keys(), damper);
    if (!table.has("continuous_mA")) {
        damper.continuous_mA = damper.ceiling_mA;
    }
    if (table.has("trip_us") && !table.has("trip_mA")) {
        table.fail("trip_us", "needs trip_mA: without it nothing trips");
    }
    damper.measures_current =
        table.boolean("measures_current", damper.measures_current != 0) ? 1 : 0;
    table.reject_unknown_keys();
}

// The whole

std::int32_t first_accelerometer(const quiesce_board_t &board) {
    for (std::int32_t i = 0; i < board.sensors; ++i) {
        if (board.sensor[i].sense == QUIESCE_SENSE_ACCEL) {
            return i;
        }
    }
    return 0;
}

/// A file that is read: its tables stay at hand for messages of the check.
class Reader {
  public:
    explicit Reader(const TomlFile &toml)
        : root_(toml.root()), sensors_(root_.tables("sensor")), dampers_(root_.tables("damper")) {}

    BoardFile read();

  private:
    void reject_unknown_keys();
    void read_root();
    void read_parts();
    void check() const;
    [[noreturn]] void refuse(const quiesce_board_error_t &error) const;
    [[noreturn]] void refuse_tracked(const std::string &reason) const;
    std::string sensor_key(const quiesce_board_sensor_t &sensor, const std::string &field) const;

    TomlTable root_;
    std::vector<TomlTable> sensors_, dampers_;
    BoardFile file_ = {};
};

/// First of all: a table with another name would seem to be missing.
void Reader::reject_unknown_keys() {
    for (const char *key : {"schema", "version", "name", "bodies", "tracked"}) {
        root_.accept(key);
    }
    for (const RootKey &key : root_keys()) {
        root_.accept(key.key);
    }
    root_.reject_unknown_keys();
}

void Reader::read_root() {
    reject_unknown_keys();
    file_.name = root_.text("name");
    require_identifier(root_, "name", file_.name);
    file_.bodies = read_bodies(root_);
    file_.sensors = read_names(sensors_);
    file_.dampers = read_names(dampers_);
    require_other_names(dampers_, file_.dampers, file_.bodies);
    require_counts(root_, file_);
    read_numbers(root_, root_keys(), file_.board);
}

void Reader::read_parts() {
    const quiesce_board_sensor_t sensor = file_.board.sensor[0];
    const quiesce_board_damper_t damper = file_.board.damper[0];
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        file_.board.sensor[i] = sensor;
        read_sensor(sensors_[i], file_, file_.board.sensor[i]);
    }
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
        file_.board.damper[i] = damper;
        read_damper(dampers_[i], file_.bodies, file_.board.damper[i]);
    }
}

BoardFile Reader::read() {
    quiesce_board_default(&file_.board);
    read_root();
    file_.board.sensors = static_cast<std::int32_t>(file_.sensors.size());
    file_.board.bodies = static_cast<std::int32_t>(file_.bodies.size());
    file_.board.dampers = static_cast<std::int32_t>(file_.dampers.size());
    read_parts();
    file_.board.tracked = root_.has("tracked") ? number_of(root_, "tracked", file_.sensors)
                                               : first_accelerometer(file_.board);
    check();
    return file_;
}

void Reader::check() const {
    quiesce_board_error_t error = {};
    if (!quiesce_board_check(&file_.board, &error)) {
        refuse(error);
    }
}

/// The key of a field: the file has names where the board has numbers.
std::string Reader::sensor_key(const quiesce_board_sensor_t &sensor,
                               const std::string &field) const {
    const Sense &sense = senses()[static_cast<std::size_t>(sensor.sense)];
    if (field == "at") {
        return sense.owner == Owner::Board ? "measures" : "of";
    }
    return field == "scale" ? sense.scale_key : field;
}

void Reader::refuse(const quiesce_board_error_t &error) const {
    const std::string part = error.part;
    const auto number = static_cast<std::size_t>(error.number);
    if (part == "sensor") {
        sensors_[number].fail(sensor_key(file_.board.sensor[number], error.name),
                              error.reason + (" (" + file_.sensors[number] + ")"));
    }
    if (part == "damper") {
        dampers_[number].fail(error.name, error.reason + (" (" + file_.dampers[number] + ")"));
    }
    refuse_tracked(error.reason);
}

void Reader::refuse_tracked(const std::string &reason) const {
    const std::string &name = file_.sensors[static_cast<std::size_t>(file_.board.tracked)];
    root_.fail("tracked", reason + " (" + name + (root_.has("tracked") ? ")" : ", the default)"));
}

} // namespace

bool is_of_board(const std::string &parameter) {
    static const Names replaced = {"accel_scale_nm_s2",  "accel_offset_counts",
                                   "accel_polarity",     "accel_full_scale_counts",
                                   "accel_axis",         "sensor_max_age_ticks",
                                   "sensor_stuck_ticks", "sensor_min_noise_counts",
                                   "safe_current_mA",    "current_check",
                                   "current_lag_ms"};
    return std::find(replaced.begin(), replaced.end(), parameter) != replaced.end();
}

std::string told(const BoardFile &file, const quiesce_signal_t &signal) {
    if (signal.at < 0) {
        return signal.name;
    }
    const bool is_of_body =
        std::any_of(senses().begin(), senses().end(), [&signal](const Sense &sense) {
            return sense.owner == Owner::Body && std::string(signal.name) == sense.name;
        });
    const Names &names = is_of_body ? file.bodies : file.dampers;
    return signal.name + (" of " + names.at(static_cast<std::size_t>(signal.at)));
}

BoardFile load_board(const std::string &file) {
    const TomlFile toml(file, "quiesce-board", 1);
    return Reader(toml).read();
}

} // namespace quiesce
