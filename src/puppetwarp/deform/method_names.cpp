#include <puppetwarp/deform/deformer.h>

#include <puppetwarp/base/errors.h>

#include <array>
#include <cassert>

namespace puppetwarp {

namespace {

struct NamedMethod {
    Method value;
    const char* name;
    bool built;  // whether `make_deformer` knows it
};

constexpr std::array<NamedMethod, 15> methods{{{Method::harmonic, "harmonic", true},
                                               {Method::biharmonic, "biharmonic", true},
                                               {Method::triharmonic, "triharmonic", false},
                                               {Method::tetraharmonic, "tetraharmonic", false},
                                               {Method::thin_shell, "thin-shell", false},
                                               {Method::laplacian, "laplacian", true},
                                               {Method::laplacian_rotated, "laplacian-rotated", true},
                                               {Method::laplacian_similarity, "laplacian-similarity", true},
                                               {Method::multiresolution, "multiresolution", true},
                                               {Method::arap, "arap", true},
                                               {Method::smooth_arap, "smooth-arap", false},
                                               {Method::fold_free, "fold-free", false},
                                               {Method::mls_affine, "mls-affine", true},
                                               {Method::mls_similarity, "mls-similarity", true},
                                               {Method::mls_rigid, "mls-rigid", true}}};

struct NamedEnergy {
    ArapEnergy value;
    const char* name;
};

constexpr std::array<NamedEnergy, 3> arap_energies{{{ArapEnergy::elements, "elements"},
                                                    {ArapEnergy::spokes, "spokes"},
                                                    {ArapEnergy::spokes_and_rims, "spokes-and-rims"}}};

bool offered(const NamedMethod& method) {
    return method.built;
}

bool offered(const NamedEnergy&) {
    return true;
}

template <typename Table>
std::string listed(const Table& table) {
    std::string list;
    for (const auto& entry : table) {
        if (offered(entry)) list += (list.empty() ? "" : ", ") + std::string(entry.name);
    }
    return list;
}

template <typename Table>
auto value_of(const Table& table, std::string_view name, const char* what) {
    for (const auto& entry : table) {
        if (offered(entry) && entry.name == name) return entry.value;
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
    for (const auto& entry : methods) {
        if (offered(entry)) names.emplace_back(entry.name);
    }
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
