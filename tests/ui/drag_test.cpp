#include "support/run_command.h"
#include "ui/driven_model.h"

#include <puppetwarp/project/pipeline.h>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace puppetwarp::ui {
namespace {

namespace fs = std::filesystem;
using tests::TemporaryFolder;

// The editor on one of the samples, its poses taken out.
class DragTest : public DrivenModel {
protected:
    void open_sample(const std::string& name) {
        Puppet puppet = read_puppet(fs::path(PUPPETWARP_SOURCE_DIR) / "images" / (name + ".puppet.json"));
        puppet.poses.clear();
        const fs::path file = folder / (name + ".puppet.json");
        write_puppet(puppet, file);
        open(file);
        settle();
    }
    Point place(const std::string& id) const {
        for (const Pin& pin : pins(editor.puppet(), editor.pose()))
            if (pin.id == id) return pin.to;
        ADD_FAILURE() << "no pin " << id;
        return {0, 0};
    }
    std::optional<double> turn_deg(const std::string& id) const {
        const Pose pose = editor.pose();
        const auto found = pose.handles.find(id);
        if (found == pose.handles.end() || !found->second.turn_rad) return {};
        return *found->second.turn_rad * 180 / std::numbers::pi;
    }
    // Drags a pin about a centre in steps of 10 degrees, each of which is seen.
    void drag_round(const std::string& id, const Point& centre, int degrees) {
        const Point from = place(id);
        editor.press(from, image_px_per_point);
        const int step = degrees < 0 ? -10 : 10;
        for (int angle = step; angle != degrees + step; angle += step) {
            const Eigen::Rotation2Dd turn(angle * std::numbers::pi / 180);
            editor.move(centre + turn * (from - centre));
            run_until([this] { return editor.up_to_date(); });
        }
        editor.release();
        settle();
    }
    // What the command makes of the file that the editor writes.
    Eigen::MatrixX2d rendered_file() {
        const fs::path file = folder / "saved.puppet.json";
        EXPECT_TRUE(editor.save_as(file));
        const Puppet saved = read_puppet(file);
        Progress progress;
        return render(saved, find_pose(saved, editor.pose_name()), {}, progress).moved;
    }
    double off_px(const Eigen::MatrixX2d& V) const {
        return (editor.shape()->moved - V).rowwise().norm().maxCoeff();
    }

    TemporaryFolder folder;
};

TEST_F(DragTest, Probe) {
    for (const char* name : {"gingerbread", "figure"}) {
        for (const Method method : {Method::arap, Method::smooth_arap, Method::fold_free}) {
            for (const int degrees : {210, 510, -520}) {
                open_sample(name);
                editor.set_method(method);
                settle();
                const bool g = std::string(name) == "gingerbread";
                const auto say = [&](const char* what, const Eigen::MatrixX2d& before) {
                std::printf("%s %s %d %s: jump %.3g px, file off %.3g, from before %.3g, flips %d, %s; turns", name, method_name(method).c_str(), degrees, what,
                            editor.shape()->jump_px, off_px(rendered_file()), off_px(before), editor.shape()->distortion.flipped_triangles, editor.shape()->error.c_str());
                for (const auto& [id, p] : editor.pose().handles) if (p.turn_rad && std::abs(*turn_deg(id)) > 9) std::printf(" %s %.0f", id.c_str(), *turn_deg(id));
                std::printf("\n");
                };
                drag_round("right hand", g ? Point(520, 410) : place("right elbow"), degrees);
                Eigen::MatrixX2d before = editor.shape()->moved;
                say("drag", before);
                // a pin on the wrist
                const Point rest = g ? Point(610, 405) : Point(809, 604);
                Eigen::Index v;
                (editor.shape()->mesh->V.rowwise() - rest.transpose()).rowwise().norm().minCoeff(&v);
                click(before.row(v).transpose() + Point(0.3,0.3));
                say("add ", before);
                before = editor.shape()->moved;
                const Point at = place(editor.tool().selected());
                drag(at, at + Point(12, 5));
                settle();
                say("pull", before);
                before = editor.shape()->moved;
                editor.remove_pin(editor.tool().selected());
                settle();
                say("rem ", before);
            }
        }
    }
}

}  // namespace
}  // namespace puppetwarp::ui
