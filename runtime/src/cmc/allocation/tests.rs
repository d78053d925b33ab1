//! The allocation finds the optimum, and the same bits in lanes.

use super::*;
use msk_physics::lanes::Lanes;
use proptest::prelude::*;

const ROWS: usize = 5;
const COLUMNS: usize = 12;

type Column = [f64; ROWS];

/// A problem with dense columns.
#[derive(Debug, Clone)]
struct Dense {
    columns: Vec<Column>,
    unknowns: Vec<Unknown<f64>>,
    wanted: [f64; ROWS],
}

fn dense(columns: usize) -> impl Strategy<Value = Dense> {
    let column = prop::array::uniform5(prop_oneof![Just(0.0), -50.0..50.0]);
    let unknown = (0.0..0.5, 0.0..0.5, 0.01..1.0).prop_map(|(low, span, cost)| Unknown { low, high: low + span, cost });
    let parts =
        (prop::collection::vec(column, columns), prop::collection::vec(unknown, columns), prop::array::uniform5(-100.0..100.0));
    parts.prop_map(|(columns, unknowns, wanted)| Dense { columns, unknowns, wanted })
}

fn inertia(row: usize) -> f64 {
    0.5 + row as f64
}

/// What a problem of this size borrows.
struct Parts {
    pattern: PathPattern,
    inertia: Vec<f64>,
    columns: Columns<f64>,
}

impl Dense {
    fn parts(&self) -> Parts {
        let mut pattern = PathPattern::default();
        pattern.rebuild(&[None; ROWS], [&[0, 1, 2, 3, 4][..]].into_iter());
        let mut matrix = vec![0.0; pattern.column.len()];
        (0..ROWS).for_each(|row| matrix[pattern.row[row].end - 1] = inertia(row));
        let mut columns = Columns::default();
        self.columns.iter().for_each(|column| columns.push(&pattern, column.iter().copied().enumerate()));
        Parts { pattern, inertia: matrix, columns }
    }

    fn problem<'a>(&'a self, parts: &'a Parts) -> Problem<'a, f64> {
        let Parts { pattern, inertia, columns } = parts;
        let Self { unknowns, wanted, .. } = self;
        Problem { pattern, inertia, columns, unknowns, wanted, count: unknowns.len() as f64 }
    }

    /// The unknowns, and whether they are the answer, by a search that goes on from `memory`.
    fn solve(&self, effort: Effort, memory: &mut Memory) -> (Vec<f64>, bool) {
        let (mut allocation, mut x) = (Allocation::new(ROWS), vec![0.0; self.unknowns.len()]);
        allocation.recall(0, memory);
        let exact = allocation.search(&self.problem(&self.parts()), effort, true);
        allocation.remember(0, memory, &mut x);
        (x, exact)
    }

    fn cost(&self, x: &[f64]) -> f64 {
        let made = |row: usize| self.columns.iter().zip(x).map(|(column, x)| column[row] * x).sum::<f64>();
        let error = |row: usize| self.wanted[row] - made(row);
        let errors: f64 = (0..ROWS).map(|row| error(row) * error(row) / inertia(row)).sum();
        errors + self.unknowns.iter().zip(x).map(|(unknown, x)| unknown.cost * x * x).sum::<f64>()
    }
}

/// Only by the interior-point method, to the last digits that matter.
const INTERIOR: Effort = Effort { tolerance: 0.0, first: 0, target: Target { gap: 1e-10, residual: 1e-9 }, last: 0 };
const EFFORTS: [Effort; 3] = [Effort::EXACT, Effort { first: 0, ..Effort::EXACT }, INTERIOR];

proptest! {
    #[test]
    fn the_answer_keeps_its_bounds_and_no_neighbour_is_better(problem in dense(COLUMNS), effort in 0..3_usize) {
        let (x, exact) = problem.solve(EFFORTS[effort], &mut Memory::new(ROWS));
        prop_assert!(exact || EFFORTS[effort] == INTERIOR);
        let best = problem.cost(&x);
        for (index, unknown) in problem.unknowns.iter().enumerate() {
            prop_assert!(unknown.low <= x[index] && x[index] <= unknown.high);
            for change in [-1e-3, 1e-3] {
                let mut neighbour = x.clone();
                neighbour[index] = (x[index] + change).clip(unknown.low, unknown.high);
                let other = problem.cost(&neighbour);
                prop_assert!(best <= other + 1e-8 * (1.0 + best), "{best} is more than {other}, with {index} by {change}; {x:?}");
            }
        }
    }

    /// Each lane lacks some of the columns, which are zero there, and searches twice: for the second time from where it has ended.
    #[test]
    fn lanes_have_the_bits_of_single_problems(
        lanes in prop::collection::vec((dense(COLUMNS), prop::array::uniform4(any::<bool>())), 3..9),
        effort in prop::sample::select(vec![Effort::EXACT, Effort::ROUGH, INTERIOR]),
    ) {
        let lanes: Vec<(Dense, Dense)> = lanes.into_iter().map(|(dense, has)| with_and_without(&dense, has)).collect();
        let mut alone = vec![Memory::new(ROWS); lanes.len()];
        let mut memories = alone.clone();
        let mut together: Allocation<Lanes> = Allocation::new(ROWS);
        // Not the first lanes, and not in order.
        let place = |lane: usize| 7 - lane;
        let gather = |value: &dyn Fn(&Dense) -> f64| {
            let mut all = Lanes::splat(0.0);
            lanes.iter().enumerate().for_each(|(lane, (dense, _))| all.set_lane(place(lane), value(dense)));
            all
        };
        let Parts { pattern, inertia, .. } = lanes[0].0.parts();
        let inertia: Vec<Lanes> = inertia.into_iter().map(Lanes::splat).collect();
        let wanted: Vec<Lanes> = (0..ROWS).map(|row| gather(&|dense| dense.wanted[row])).collect();
        let mut columns = Columns::default();
        (0..COLUMNS).for_each(|index| columns.push(&pattern, (0..ROWS).map(|row| (row, gather(&|dense| dense.columns[index][row])))));
        let unknown = |index: usize| Unknown {
            low: gather(&|dense| dense.unknowns[index].low),
            high: gather(&|dense| dense.unknowns[index].high),
            cost: gather(&|dense| dense.unknowns[index].cost),
        };
        let unknowns: Vec<Unknown<Lanes>> = (0..COLUMNS).map(unknown).collect();
        let mut count = Lanes::splat(0.0);
        lanes.iter().enumerate().for_each(|(lane, (_, own))| count.set_lane(place(lane), own.unknowns.len() as f64));
        let problem =
            Problem { pattern: &pattern, inertia: &inertia, columns: &columns, unknowns: &unknowns, wanted: &wanted, count };
        for _ in 0..2 {
            memories.iter().enumerate().for_each(|(lane, memory)| together.recall(place(lane), memory));
            together.search(&problem, effort, Lanes::mask(|lane| lane + lanes.len() > 7));
            for (lane, (_, own)) in lanes.iter().enumerate() {
                let mut found = [0.0; COMMON];
                together.remember(place(lane), &mut memories[lane], &mut found);
                let (x, _) = own.solve(effort, &mut alone[lane]);
                prop_assert_eq!(&found[..], &x[..COMMON], "lane {}", lane);
                prop_assert_eq!(&memories[lane], &alone[lane], "lane {}", lane);
            }
        }
    }
}

/// Columns that all lanes have.
const COMMON: usize = 4;

/// The problem without some pairs of its last columns: with zeros in their places, and as it is alone.
fn with_and_without(dense: &Dense, has: [bool; 4]) -> (Dense, Dense) {
    let (mut padded, mut alone) = (dense.clone(), dense.clone());
    (alone.columns, alone.unknowns) = (Vec::new(), Vec::new());
    for index in 0..COLUMNS {
        if index < COMMON || has[(index - COMMON) / 2] {
            alone.columns.push(dense.columns[index]);
            alone.unknowns.push(dense.unknowns[index]);
        } else {
            padded.columns[index] = [0.0; ROWS];
            padded.unknowns[index] = Unknown { low: 0.0, high: 0.0, cost: 1.0 };
        }
    }
    (padded, alone)
}

#[test]
fn unknowns_without_room_stay_where_they_are() {
    let columns = vec![[3.0; ROWS], [-2.0; ROWS]];
    let unknowns = vec![Unknown { low: 0.3, high: 0.3, cost: 0.01 }, Unknown { low: 0.0, high: 1.0, cost: 0.01 }];
    let problem = Dense { columns, unknowns, wanted: [-5.0; ROWS] };
    for effort in EFFORTS {
        let (x, _) = problem.solve(effort, &mut Memory::new(ROWS));
        assert_eq!(x[0], 0.3);
        assert!((x[1] - 1.0).abs() < 1e-6, "{x:?}");
    }
}

/// Full steps go round in a circle here, from where they begin at first and from where they do so anew.
#[test]
fn opposed_muscles_do_not_send_the_interior_point_method_round_in_a_circle() {
    let columns = vec![[0.0, 0.0, -30.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 10.0], [0.0, 0.0, 10.0, 0.0, -10.0]];
    let unknown = |low: f64, high: f64| Unknown { low, high, cost: 0.01 };
    let unknowns = vec![unknown(0.1, 0.5), unknown(0.5, 1.0), unknown(0.5, 0.6)];
    let problem = Dense { columns, unknowns, wanted: [100.0, 60.0, 0.0, -40.0, 0.0] };
    let (x, _) = problem.solve(INTERIOR, &mut Memory::new(ROWS));
    let (exact, _) = problem.solve(Effort::EXACT, &mut Memory::new(ROWS));
    x.iter().zip(&exact).for_each(|(x, exact)| assert!((x - exact).abs() < 1e-6, "{x} is not {exact}"));
}

#[test]
fn a_single_muscle_meets_a_small_wish_and_saturates_at_a_large_one() {
    let asked = |wanted: f64| {
        let columns = vec![[100.0, 0.0, 0.0, 0.0, 0.0]];
        let unknowns = vec![Unknown { low: 0.0, high: 1.0, cost: 1e-6 }];
        let problem = Dense { columns, unknowns, wanted: [wanted, 0.0, 0.0, 0.0, 0.0] };
        problem.solve(Effort::EXACT, &mut Memory::new(ROWS)).0[0]
    };
    assert!((asked(30.0) - 0.3).abs() < 1e-6);
    assert_eq!(asked(1e4), 1.0);
}

#[test]
fn what_is_not_a_number_is_forgotten() {
    let problem = |wanted: f64| Dense {
        columns: vec![[3.0; ROWS]],
        unknowns: vec![Unknown { low: 0.0, high: 1.0, cost: 0.01 }],
        wanted: [wanted; ROWS],
    };
    let mut memory = Memory::new(ROWS);
    problem(f64::NAN).solve(Effort::EXACT, &mut memory);
    assert_eq!(problem(2.0).solve(Effort::EXACT, &mut memory), problem(2.0).solve(Effort::EXACT, &mut Memory::new(ROWS)));
}
