#include <puppetwarp/weights/weights.h>

#include <puppetwarp/base/errors.h>

#include <array>
#include <cassert>

namespace puppetwarp {

namespace {

template <typename Enum>
struct Named {
    Enum value;
    const char* name;
};

constexpr std::array<Named<WeightKind>, 10> kinds{{{WeightKind::shepard, "shepard"},
                                                   {WeightKind::harmonic, "harmonic"},
                                                   {WeightKind::biharmonic, "biharmonic"},
                                                   {WeightKind::bbw, "bbw"},
                                                   {WeightKind::l1, "l1"},
                                                   {WeightKind::monotonic, "monotonic"},
                                                   {WeightKind::mean_value, "mean-value"},
                                                   {WeightKind::harmonic_cage, "harmonic-cage"},
                                                   {WeightKind::green, "green"},
                                                   {WeightKind::cauchy, "cauchy"}}};

constexpr std::array<Named<Partition>, 2> partitions{
    {{Partition::coupled, "coupled"}, {Partition::normalised, "normalised"}}};

template <typename Table>
auto value_of(const Table& table, std::string_view name, const char* what) {
    std::string list;
    for (const auto& entry : table) {
        if (entry.name == name) return entry.value;
        list += (list.empty() ? "" : ", ") + std::string(entry.name);
    }
    throw InvalidInput(std::string(what) + " '" + std::string(name) + "'", "there is none of this name",
                       "known: " + list);
}

template <typename Table, typename Enum>
std::string name_of(const Table& table, Enum value) {
    for (const auto& entry : table) {
        if (entry.value == value) return entry.name;
    }
    assert(false);
    return {};
}

}  // namespace

std::vector<std::string> weight_kind_names() {
    std::vector<std::string> names;
    names.reserve(kinds.size());
    for (const auto& entry : kinds) names.emplace_back(entry.name);
    return names;
}

std::string weight_kind_name(WeightKind kind) {
    return name_of(kinds, kind);
}

WeightKind weight_kind_from_name(std::string_view name) {
    return value_of(kinds, name, "weights");
}

std::string partition_name(Partition partition) {
    return name_of(partitions, partition);
}

Partition partition_from_name(std::string_view name) {
    return value_of(partitions, name, "partition");
}

}  // namespace puppetwarp
