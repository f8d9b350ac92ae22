#include <puppetwarp/deform/deformer.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/deform/arap.h>
#include <puppetwarp/deform/polyharmonic.h>

#include <array>
#include <cassert>
#include <cmath>

namespace puppetwarp {

namespace {

template <typename Enum>
struct Named {
    Enum value;
    const char* name;
};

constexpr std::array<Named<Method>, 3> methods{
    {{Method::harmonic, "harmonic"}, {Method::biharmonic, "biharmonic"}, {Method::arap, "arap"}}};

constexpr std::array<Named<ArapEnergy>, 3> arap_energies{{{ArapEnergy::elements, "elements"},
                                                          {ArapEnergy::spokes, "spokes"},
                                                          {ArapEnergy::spokes_and_rims, "spokes-and-rims"}}};

template <typename Table>
std::string listed(const Table& table) {
    std::string list;
    for (const auto& entry : table) list += (list.empty() ? "" : ", ") + std::string(entry.name);
    return list;
}

template <typename Table>
auto value_of(const Table& table, std::string_view name, const char* what) {
    for (const auto& entry : table) {
        if (entry.name == name) return entry.value;
    }
    throw InvalidInput(std::string(what) + " '" + std::string(name) + "'", "there is none of this name",
                       "known: " + listed(table));
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

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    names.reserve(methods.size());
    for (const auto& entry : methods) names.emplace_back(entry.name);
    return names;
}

std::string method_name(Method method) {
    return name_of(methods, method);
}

Method method_from_name(std::string_view name) {
    return value_of(methods, name, "method");
}

std::string arap_energy_name(ArapEnergy energy) {
    return name_of(arap_energies, energy);
}

ArapEnergy arap_energy_from_name(std::string_view name) {
    return value_of(arap_energies, name, "arap energy");
}

std::unique_ptr<Deformer> make_deformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig) {
    if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
        throw InvalidInput("tolerance", "must be a number above 0");
    }
    if (options.max_iterations < 1) throw InvalidInput("max_iterations", "must be at least 1");
    require_sound(mesh, "mesh");
    require_sound(rig);
    switch (options.method) {
        case Method::harmonic: return std::make_unique<PolyharmonicDeformer>(1, mesh, rig);
        case Method::biharmonic: return std::make_unique<PolyharmonicDeformer>(2, mesh, rig);
        case Method::arap: break;
    }
    return std::make_unique<ArapDeformer>(options, mesh, rig);
}

}  // namespace puppetwarp
