//! The longer texts of `--help`: examples and the conventions of the map formats.

use maps::formats::{geojson, iplan, movingai, osm, pcf, ros, tags};

pub(super) const EXAMPLES: &str = "\
Examples:
  plan-compiler build tests/maps/campus.opar -o campus.bin
      Compiles a map. Its named points become goals; campus.mission.toml beside it is
      read automatically. Run these examples in the project's folder.
  plan-compiler build tests/maps/yard.osm --goal gate=-17.5,17.5 --goal shed=14,14 --resolution 0.5
      Compiles for two goals that you choose, with cells of 0.5 m.
  plan-compiler build tests/maps/yard.osm --goal gate=geo:51.00036,7.00018 -o gate.bin
      The same, for a goal given by latitude and longitude.
  plan-compiler build tests/maps/stations.ovl -o fuel.bin
      Compiles one plan that leads to the cheapest of three goals, as its mission says.
  plan-compiler build tests/maps/campus.opar --board nrf52840-dk -o plans.hex
      Refuses plans that do not fit the board's flash, and writes a file for flashing
      that contains their address: .hex, or .uf2 for pico2.
  plan-compiler inspect plans.bin
      Shows what a blob contains.
  plan-compiler query plans.bin --layer gate/physical --at -26,-18
      Looks up the advice at one point, as the robot does.
  plan-compiler query plans.bin --layer gate/physical --route -26,-18 --format csv
      Prints the whole route from a point; --format geojson suits map viewers.
  plan-compiler export plans.bin --layer gate/physical --what cost -o cost.npy
      Writes every cell's cost to the goal as a NumPy array.
  plan-compiler render plans.bin --layer gate/physical -o field.png
      Draws obstacles, cost bands and the advice.
  plan-compiler render plans.bin --layer gate/physical --layers --route -26,-18 -o routes.png
      Draws all layers of plan gate in one picture, each with the route from a point.
  plan-compiler comms tests/maps/campus.opar --place base=20,20 -o reach.png
      Draws where a radio reaches a base at (20, 20), and prints the share of cells
      where it does not.
  plan-compiler cover tests/maps/glebe.geojson --area Glebe --width 4 --plan-each \\
    -o tests/maps/mow.mission.toml
      Writes a mission that drives strips over an area, around its obstacles; a plan leads to
      each strip, also after refuelling.
  plan-compiler graph tests/maps/plough.mission.toml -o plough.svg
      Draws behaviours and their plans as graphs.
  plan-compiler verify plans.bin --map tests/maps/yard.osm
      Re-proves every cell of every layer, and compares the blob with the map.
  plan-compiler convert plans.bin -o Iplan.dat
      Writes the plans in MissionLab's format.

Exit status: 0 done, 1 the input is wrong, 2 the command line is wrong.";

const ASSUMPTIONS: &str = "\
Map formats and their conventions:
  All      Metres, x east, y north. A cell is blocked if an obstacle's exact shape, grown by
           the robot's radius, touches it. The radius is --robot-radius, else the mission's,
           else its vehicle's (0.3 m); it is 0 in MovingAI maps and Iplan.dat, where the
           robot is a point. A diagonal step needs both cells beside it free, unless
           --corners allow is given.
  Overlay  (MissionLab .ovl) ORIGIN is added to coordinates and subtracted from UTM ones.
           UTM LAT/LON is converted with WGS-84, not with the historic Clarke 1866. HEADING
           is the direction of the map's y axis, in degrees clockwise from true north; it
           affects only positions on the globe. OBSTACLE gives a radius, OBJECT a diameter;
           OBJECTs block only if FIXED. Walls are lines: the inside of a closed wall is
           unreachable, and blocked only with --fill-walls. BOUNDARYs with NoCommZone in
           their names are obstacles in layer `comms`; NoFlyZones and WeatherZones only if a
           mission asks for it. A comment `--RESOLUTION 1.0` sets the cell size.
  OPAR     WGS-84 decimal degrees. Deltas are metres (--opar-units deg for degrees), each
           an offset from its record's position, east before north (--opar-order ne for
           the reverse). The points form a closed polygon. Type 1 is a building, which is an
           obstacle; type 2 is foliage, which weakens radio and is an obstacle in layer
           `comms` only (--opar-type N=building|foliage sets other types). Everything
           outside the area's polygon is blocked.";

const MISSIONS: &str = "\
A mission file NAME.mission.toml beside the map NAME sets goals, layers, the robot's radius,
speeds and gains; MISSION.md lists its keys.";

pub(super) const RADIO: &str = "\
The margin of a link is the received power above the receiver's sensitivity. Cells with a margin
below the threshold are out of reach. With several places, the worst link of a cell counts, or the
best with --need any. A mission with a table [radio] has the same cells as obstacles in layer
`comms`; options that are not given are those of that table.

Loss: free space (ITU-R P.525), diffraction over the tops of obstacles (ITU-R P.526, Deygout's
method with up to three edges), and foliage (Weissberger, with the coefficients of an OPAR map).
Heights are the map's: OPAR, `height` or `building:levels` in OpenStreetMap and GeoJSON, the last
number of an overlay's OBSTACLE or WALL; otherwise --obstacle-height. Occupied cells of a ROS or
MovingAI map have that height too. Water, rails, steps and what --block adds lie flat. Obstacles up
to --small do not count. The ground is level. Not included: reflections, fading, and ways
around the sides of obstacles.

An array .npy is float32, dB, [row, column], row 0 in the south.

Examples:
  plan-compiler comms tests/maps/campus.opar --place base=20,20 --place mate=200,30 -o reach.svg
  plan-compiler comms tests/maps/yard.osm --place base=-26,-18 --antenna 0.5 --place-antenna 4
  plan-compiler comms tests/maps/shop.ovl --place dock=5,5 --frequency 0.868 --power 14 -o shop.npy";

pub(super) const COVERAGE: &str = "\
The area falls into parts where obstacles split it. The strips of a part lie at equal distances,
--width less --overlap or closer, over the cells that the robot may enter, and alternate in
direction. The part with the nearest end comes next. Beside slanted edges and in bays, short
strips fill the gaps. Strips keep the robot's radius from obstacles and from the edge of the
area; --edge sets another distance from the edge. Without --angle, the direction that needs the
fewest strips is chosen among those of the area's edges and multiples of 30 degrees. Transitions
between strips stay in the area where they can.

A point counts as covered within half the width and half a cell of a strip; the share within half
the width is printed too. What stays uncovered is reported: ground beside obstacles and edges that
is too far from every strip, ground that the robot cannot reach from its start, gaps up to --leave,
and what only a strip shorter than half a cell would reach. So is the part of the area off the map,
which does not count. A strip that fills a gap is at least half the width long where it has room.

The mission that is written keeps everything of the mission that it adds to, and replaces only
what an earlier run wrote: the strips, and the tolerance from their width. A name of the user that
strips need is refused, and so is an output that is another mission. The mission that is written
has a behaviour `cover`, one `go-to` action for each end of a strip, and a plan to the first strip
and wherever the transition to the next leads around obstacles. A strip that cannot be driven in
time is skipped. Other behaviours of the mission that lead the robot away wait for the end of a
strip if their actions have delete = [\"at strip\"]; then --plan-each leads it back.

Examples:
  plan-compiler cover tests/maps/meadow.geojson --area Meadow --width 3 -o strips.png
  plan-compiler cover tests/maps/shop.ovl --corner 2,2 --corner 20,2 --corner 20,15 --width 1
  plan-compiler cover tests/maps/meadow.geojson --area Mud --width 2 --angle 90 -o strips.geojson";

pub(super) const CONVERSIONS: &str = "\
A map is compiled as `build` does; the options for this do not apply to blobs.

The contingency map of an Iplan.dat is the first layer of plan `contingency`; if there is no such
plan, it is the first layer of the plan that the robot follows. Each layer, except the first of
`contingency`, becomes a MOVETO element. Costs are in metres; 9998 marks an obstacle, 9999 a
cell without a route. Positions are relative to the centre of the south-west cell. With
--corners allow, the costs equal those of the historic program.

Examples:
  plan-compiler convert tests/maps/shop.ovl -o Iplan.dat
  plan-compiler convert Iplan.dat --corners allow -o plans.bin
  plan-compiler convert plans.bin -o Iplan.dat";

/// The conventions of every format. Those of the first two stand here; each other reader documents
/// its own.
pub(super) fn assumptions() -> String {
    let formats = [
        ros::CONVENTIONS,
        movingai::CONVENTIONS,
        geojson::CONVENTIONS,
        osm::CONVENTIONS,
        tags::CONVENTIONS,
        iplan::CONVENTIONS,
        pcf::CONVENTIONS,
    ];
    let formats = formats.map(|text| format!("\n  {}", text.replace('\n', "\n  "))).concat();
    format!("{ASSUMPTIONS}{formats}\n\n{MISSIONS}")
}
