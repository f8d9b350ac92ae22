#include "model/history.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace puppetwarp::ui {
namespace {

void set(History<std::string>& history, const std::string& value) {
    auto edit = history.edit(std::string("set ").append(value));
    edit.value() = value;
    edit.commit();
}

TEST(HistoryTest, AnEditShowsAtOnceAndIsRolledBackUnlessCommitted) {
    History<std::string> history("a");
    {
        auto edit = history.edit("half");
        edit.value() = std::string("b");
        EXPECT_EQ(history.current(), "b");
        EXPECT_TRUE(history.editing());
        EXPECT_TRUE(history.modified());
    }
    EXPECT_EQ(history.current(), "a");
    EXPECT_FALSE(history.editing());
    EXPECT_FALSE(history.modified());
    EXPECT_FALSE(history.can_undo());
}

TEST(HistoryTest, AnEditThatMovesOnIsStillOneEdit) {
    History<std::string> history("a");
    {
        auto edit = history.edit("moved");
        auto heir = std::move(edit);
        heir.value() = std::string("b");
        heir.commit();
    }
    EXPECT_EQ(history.current(), "b");
    history.undo();
    EXPECT_EQ(history.current(), "a");
    EXPECT_FALSE(history.can_undo());
}

TEST(HistoryTest, NothingIsUndoneWhileAnEditIsOpen) {
    History<std::string> history("a");
    set(history, "b");
    auto edit = history.edit("open");
    EXPECT_FALSE(history.can_undo());
    EXPECT_FALSE(history.can_redo());
}

TEST(HistoryTest, NamesWhatUndoAndRedoWouldDo) {
    History<std::string> history("a");
    EXPECT_EQ(history.undo_name(), "");
    set(history, "b");
    set(history, "c");
    EXPECT_EQ(history.undo_name(), "set c");
    history.undo();
    EXPECT_EQ(history.undo_name(), "set b");
    EXPECT_EQ(history.redo_name(), "set c");
}

TEST(HistoryTest, ComingBackToTheSavedStepIsNotModified) {
    History<std::string> history("a");
    set(history, "b");
    history.mark_saved(history.snapshot());
    EXPECT_FALSE(history.modified());
    set(history, "c");
    EXPECT_TRUE(history.modified());
    history.undo();
    EXPECT_FALSE(history.modified());
    history.undo();
    EXPECT_TRUE(history.modified());
}

TEST(HistoryTest, ASavedStepThatWasReplacedStaysModified) {
    History<std::string> history("a");
    set(history, "b");
    history.mark_saved(history.snapshot());
    history.undo();
    set(history, "c");
    EXPECT_TRUE(history.modified());
    EXPECT_FALSE(history.can_redo());
    history.undo();
    EXPECT_TRUE(history.modified());
}

TEST(HistoryTest, AStepCanBeAmendedWhereverOneStands) {
    History<std::string> history("a");
    set(history, "b");
    const auto step = history.snapshot();
    set(history, "c");
    history.mark_saved(history.snapshot());
    EXPECT_TRUE(history.amend(step, "b and more"));
    EXPECT_EQ(history.current(), "c");
    EXPECT_FALSE(history.modified());
    EXPECT_FALSE(history.amend(step, "b again")) << "what was replaced is gone";
    history.undo();
    EXPECT_EQ(history.current(), "b and more");
    EXPECT_EQ(history.undo_name(), "set b");
    EXPECT_TRUE(history.can_redo());
}

TEST(HistoryTest, ASavedStepThatWasAmendedIsModified) {
    History<std::string> history("a");
    set(history, "b");
    history.mark_saved(history.snapshot());
    history.amend(history.snapshot(), "b and more");
    EXPECT_TRUE(history.modified());
}

TEST(HistoryTest, SnapshotsOutliveTheHistory) {
    std::shared_ptr<const std::string> kept;
    {
        History<std::string> history("a");
        set(history, "b");
        kept = history.snapshot();
    }
    EXPECT_EQ(*kept, "b");
}

// Against a plain list of all values and an index, over random deeds.
TEST(HistoryTest, BehavesAsAListOfValues) {
    std::mt19937 random(7);
    History<std::string> history("0");
    std::vector<std::string> values{"0"};
    std::size_t at = 0;
    for (int step = 1; step < 2000; ++step) {
        switch (random() % 4) {
            case 0:
                values.resize(at + 1);
                values.push_back(std::to_string(step));
                ++at;
                set(history, values.back());
                break;
            case 1:
                ASSERT_EQ(history.can_undo(), at > 0);
                if (at > 0) {
                    --at;
                    history.undo();
                }
                break;
            case 2:
                ASSERT_EQ(history.can_redo(), at + 1 < values.size());
                if (at + 1 < values.size()) {
                    ++at;
                    history.redo();
                }
                break;
            default: history.edit("given up").value() = std::string("nothing"); break;
        }
        ASSERT_EQ(history.current(), values[at]);
    }
}

}  // namespace
}  // namespace puppetwarp::ui
