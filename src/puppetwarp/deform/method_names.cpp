#include <puppetwarp/deform/deformer.h>

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

constexpr std::array<Named<Method>, 19> methods{{{Method::harmonic, "harmonic"},
                                                 {Method::biharmonic, "biharmonic"},
                                                 {Method::triharmonic, "triharmonic"},
                                                 {Method::tetraharmonic, "tetraharmonic"},
                                                 {Method::thin_shell, "thin-shell"},
                                                 {Method::laplacian, "laplacian"},
                                                 {Method::laplacian_rotated, "laplacian-rotated"},
                                                 {Method::laplacian_similarity, "laplacian-similarity"},
                                                 {Method::multiresolution, "multiresolution"},
                                                 {Method::arap, "arap"},
                                                 {Method::smooth_arap, "smooth-arap"},
                                                 {Method::fold_free, "fold-free"},
                                                 {Method::fast, "fast"},
                                                 {Method::lbs, "lbs"},
                                                 {Method::dual_complex, "dual-complex"},
                                                 {Method::intrinsic, "intrinsic"},
                                                 {Method::mls_affine, "mls-affine"},
                                                 {Method::mls_similarity, "mls-similarity"},
                                                 {Method::mls_rigid, "mls-rigid"}}};

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

}  // namespace puppetwarp
