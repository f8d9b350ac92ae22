#pragma once
// Private header.

#include <puppetwarp/mesh/clearance.h>

#include <optional>
#include <utility>
#include <vector>

namespace puppetwarp {

//! What a cage keeps to. Lengths in the unit of its coordinates.
struct CageRules {
    double clearance = 0;      //!< from the subject
    double gap = 0;            //!< between edges that are not neighbours
    double min_angle_rad = 0;  //!< between neighbours, inside and outside
    double edge_cost = 0;      //!< what a unit of an edge's length costs, in units of area
};

//! What a polygon costs: its area, and its length times `rules.edge_cost`. Both fall as it draws near to what it holds;
//! length alone keeps it out of gaps too narrow for their depth, and from spikes.
double cage_cost(const Polyline& polygon, const CageRules& rules);

//! A polygon around a subject, changed corner by corner; it always holds the subject and never crosses itself.
//! Corners are merged two by two, where that costs least, after the progressive hulls of Sander et al. 2000; unlike
//! there, a merged corner may go anywhere as long as the subject is inside, and corners move afterwards.
class CageShaper {
public:
    //! \param subject  what the polygon holds: outlives this.
    //! \param within   a place of the subject.
    //! \param start    a polygon of positive area that keeps to the rules.
    CageShaper(const Clearance& subject, const Point& within, const CageRules& rules, Polyline start);

    //! Merges corners until there are at most `most`, and further as long as a corner saves less than `worthless`.
    //! \return whether the rules allowed that.
    bool reduce(std::size_t most, double worthless);

    //! Moves every corner to where it costs least, as long as that helps.
    void settle();

    //! Adds corners where they save most as long as each saves `worthless` and there are no more than `most`; then
    //! trades corners, one more where it saves most for one fewer where it costs least, and turns edges.
    void refine(std::size_t most, double worthless);

    const Polyline& polygon() const { return corners_; }
    double cost() const { return cage_cost(corners_, rules_); }

private:
    //! A corner in place of others: the cost that it adds.
    struct Change {
        Point corner;
        double cost = 0;
    };
    //! The merge of a corner with the next, where it is known; nothing where none is allowed.
    struct Known {
        bool known = false;
        std::optional<Change> change;
    };
    //! A new corner on the edge from a corner.
    struct Split {
        std::size_t edge;
        Change change;
    };

    std::size_t count() const { return corners_.size(); }
    const Point& at(std::size_t k) const { return corners_[k % corners_.size()]; }
    //! What the way from `from` over `corner` to `to` costs, as a part of the polygon.
    double way_cost(const Point& from, const Point& corner, const Point& to) const;

    bool angle_is_wide(const Point& a, const Point& joint, const Point& b) const;
    //! \param changed  a polygon whose first corners, `fresh` of them, are new.
    bool keeps_gaps(const Polyline& changed, std::size_t fresh) const;
    //! Whether the corners of `fresh` may stand in place of the `replaced` corners from `first` on.
    bool allowed(std::size_t first, std::size_t replaced, const Polyline& fresh) const;
    //! Moves `change.corner`, in place of the `replaced` corners from `first` on, to where it costs least.
    //! \pre it is allowed where it is. \param step  how far it tries to go at first.
    void slide(std::size_t first, std::size_t replaced, double step, Change& change) const;
    //! Puts it there, as the first corner of the polygon.
    void put(std::size_t first, std::size_t replaced, const Point& corner);
    //! After corners were moved.
    void forget_merges(std::size_t first, std::size_t moved);

    //! How many corners after this one cost least when they are left out together; 0 when that saves nothing.
    std::size_t run_to_leave_out(std::size_t first) const;
    //! Leaves out corners whose leaving out saves something: the edges of inlets too narrow for their depth.
    void close_inlets();

    //! The cheapest corner in place of one and the next.
    std::optional<Change> best_merge(std::size_t first) const;
    //! The cheapest merge and its first corner.
    std::optional<std::pair<std::size_t, Change>> cheapest_merge();
    //! \return whether one was allowed and cost no more than `most_cost`.
    bool merge_cheapest(double most_cost);

    Change best_split(std::size_t edge) const;
    //! Of every edge, best first.
    std::vector<Split> splits() const;
    //! \return whether a trade saved something.
    bool trade(double worthless);

    //! Each of these tells whether something was moved.
    bool settle_corner(std::size_t corner);
    //! Turns the edge from a corner about what it touches, its ends along the edges before and after it.
    bool turn_edge(std::size_t corner);
    //! Where one of the two ends that are to replace a corner and the next comes to when it is drawn back along `way`
    //! as far as is allowed, less than `room`.
    Point pulled_in(std::size_t corner, Polyline ends, std::size_t end, const Point& way, double room) const;
    void settle_around(std::size_t corner);
    void settle_edges();

    const Clearance& subject_;
    Point within_;
    CageRules rules_;
    Polyline corners_;
    std::vector<Known> merges_;  // of each corner
};

}  // namespace puppetwarp
