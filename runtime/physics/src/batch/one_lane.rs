//! Episodes moved into lanes and out of them.

use crate::{
    lanes::{Lanes, WIDTH},
    scalar::Real,
};
use nalgebra::{Matrix3, Vector3};

/// Something for every lane; `None` where a lane is left out.
pub(crate) type PerLane<T> = [Option<T>; WIDTH];

/// The share that one lane has in something of eight episodes.
pub(crate) trait OneLane<All: ?Sized> {
    /// Becomes what the lane holds. Lists are as long as each other, or empty.
    fn read_lane(&mut self, all: &All, lane: usize);
    /// Replaces what the lane holds.
    fn write_lane(&self, all: &mut All, lane: usize);

    /// [`read_lane`](Self::read_lane) of several, to which a long list comes once instead of once for each.
    fn read_lanes(ones: &mut PerLane<&mut Self>, all: &All) {
        for (lane, one) in ones.iter_mut().enumerate() {
            one.iter_mut().for_each(|one| one.read_lane(all, lane));
        }
    }
    /// [`write_lane`](Self::write_lane) of several, likewise.
    fn write_lanes(ones: &PerLane<&Self>, all: &mut All) {
        for (lane, one) in ones.iter().enumerate() {
            one.iter().for_each(|one| one.write_lane(all, lane));
        }
    }
}

/// Bytes of a list that go through all lanes before the next: what the nearest cache holds beside their shares.
const BLOCK: usize = 8192;

/// Entries of a list in a block.
const fn block<All>() -> usize {
    let entries = BLOCK / if size_of::<All>() == 0 { 1 } else { size_of::<All>() };
    if entries == 0 { 1 } else { entries }
}

impl OneLane<Lanes> for f64 {
    #[inline(always)]
    fn read_lane(&mut self, all: &Lanes, lane: usize) {
        *self = all.lane(lane);
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut Lanes, lane: usize) {
        all.set_lane(lane, *self);
    }
}

impl<One: OneLane<All>, All> OneLane<[All]> for [One] {
    #[inline(always)]
    fn read_lane(&mut self, all: &[All], lane: usize) {
        self.iter_mut().zip(all).for_each(|(one, all)| one.read_lane(all, lane));
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut [All], lane: usize) {
        self.iter().zip(all).for_each(|(one, all)| one.write_lane(all, lane));
    }
}

impl<One: OneLane<All>, All> OneLane<Vec<All>> for Vec<One> {
    #[inline(always)]
    fn read_lane(&mut self, all: &Vec<All>, lane: usize) {
        self.as_mut_slice().read_lane(all.as_slice(), lane);
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut Vec<All>, lane: usize) {
        self.as_slice().write_lane(all.as_mut_slice(), lane);
    }
    fn read_lanes(ones: &mut PerLane<&mut Self>, all: &Vec<All>) {
        let entries = block::<All>();
        for (index, part) in all.chunks(entries).enumerate() {
            for (lane, one) in ones.iter_mut().enumerate() {
                let own = one.as_mut().and_then(|one| one.get_mut(index * entries..));
                own.into_iter().for_each(|own| own.read_lane(part, lane));
            }
        }
    }
    fn write_lanes(ones: &PerLane<&Self>, all: &mut Vec<All>) {
        let entries = block::<All>();
        for (index, part) in all.chunks_mut(entries).enumerate() {
            for (lane, one) in ones.iter().enumerate() {
                let own = one.and_then(|one| one.get(index * entries..));
                own.into_iter().for_each(|own| own.write_lane(part, lane));
            }
        }
    }
}

impl<One: OneLane<All>, All, const SIZE: usize> OneLane<[All; SIZE]> for [One; SIZE] {
    #[inline(always)]
    fn read_lane(&mut self, all: &[All; SIZE], lane: usize) {
        self.as_mut_slice().read_lane(all.as_slice(), lane);
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut [All; SIZE], lane: usize) {
        self.as_slice().write_lane(all.as_mut_slice(), lane);
    }
}

impl OneLane<Vector3<Lanes>> for Vector3<f64> {
    #[inline(always)]
    fn read_lane(&mut self, all: &Vector3<Lanes>, lane: usize) {
        self.as_mut_slice().read_lane(all.as_slice(), lane);
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut Vector3<Lanes>, lane: usize) {
        self.as_slice().write_lane(all.as_mut_slice(), lane);
    }
}

impl OneLane<Matrix3<Lanes>> for Matrix3<f64> {
    #[inline(always)]
    fn read_lane(&mut self, all: &Matrix3<Lanes>, lane: usize) {
        self.as_mut_slice().read_lane(all.as_slice(), lane);
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut Matrix3<Lanes>, lane: usize) {
        self.as_slice().write_lane(all.as_mut_slice(), lane);
    }
}

impl<A: OneLane<AllA>, B: OneLane<AllB>, AllA, AllB> OneLane<(AllA, AllB)> for (A, B) {
    #[inline(always)]
    fn read_lane(&mut self, all: &(AllA, AllB), lane: usize) {
        self.0.read_lane(&all.0, lane);
        self.1.read_lane(&all.1, lane);
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut (AllA, AllB), lane: usize) {
        self.0.write_lane(&mut all.0, lane);
        self.1.write_lane(&mut all.1, lane);
    }
}

impl<One: OneLane<All>, All> OneLane<Option<All>> for Option<One> {
    #[inline(always)]
    fn read_lane(&mut self, all: &Option<All>, lane: usize) {
        self.iter_mut().zip(all).for_each(|(one, all)| one.read_lane(all, lane));
    }
    #[inline(always)]
    fn write_lane(&self, all: &mut Option<All>, lane: usize) {
        self.iter().zip(all).for_each(|(one, all)| one.write_lane(all, lane));
    }
    fn read_lanes(ones: &mut PerLane<&mut Self>, all: &Option<All>) {
        if let Some(all) = all {
            One::read_lanes(&mut ones.each_mut().map(|one| one.as_mut().and_then(|one| one.as_mut())), all);
        }
    }
    fn write_lanes(ones: &PerLane<&Self>, all: &mut Option<All>) {
        if let Some(all) = all {
            One::write_lanes(&ones.map(|one| one.and_then(Option::as_ref)), all);
        }
    }
}

/// Makes [`OneLane`] of a struct, field by field. Fields after `but` are left as they are: what follows from the model, and scratch.
macro_rules! one_lane {
    ($name:ident { $($field:ident),* $(; but $($left:ident),*)? }) => {
        impl crate::batch::OneLane<$name<crate::lanes::Lanes>> for $name<f64> {
            fn read_lane(&mut self, all: &$name<crate::lanes::Lanes>, lane: usize) {
                // A field that is forgotten here does not compile.
                let $name { $($field,)* $($($left: _,)*)? } = all;
                $(crate::batch::OneLane::read_lane(&mut self.$field, $field, lane);)*
            }
            fn write_lane(&self, all: &mut $name<crate::lanes::Lanes>, lane: usize) {
                $(crate::batch::OneLane::write_lane(&self.$field, &mut all.$field, lane);)*
            }
            fn read_lanes(ones: &mut crate::batch::PerLane<&mut Self>, all: &$name<crate::lanes::Lanes>) {
                $(crate::batch::OneLane::read_lanes(
                    &mut ones.each_mut().map(|one| one.as_mut().map(|one| &mut one.$field)),
                    &all.$field,
                );)*
            }
            fn write_lanes(ones: &crate::batch::PerLane<&Self>, all: &mut $name<crate::lanes::Lanes>) {
                $(crate::batch::OneLane::write_lanes(&ones.map(|one| one.map(|one| &one.$field)), &mut all.$field);)*
            }
        }
    };
}
pub(crate) use one_lane;
