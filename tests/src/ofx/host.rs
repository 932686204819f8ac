//! A host, as plugins are given it.

use super::properties::{Set, Value};
use super::state::{Behaviour, Inner};
use super::suites::{self, Suites};
use isophote_abi::openfx::*;
use std::sync::Arc;

/// A host. A plugin knows one at a time: a test has a copy of the library to itself
/// ([`Lent`](super::plugin::Lent)), and may have several hosts one after the other.
#[derive(Debug)]
pub struct Host {
    /// State that its handles lead to.
    pub inner: Arc<Inner>,
    properties: Box<Set>,
    raw: Box<OfxHost>,
    _suites: Box<Suites>,
}

// SAFETY: what the pointers lead to is constant or behind locks, and lives as long as the host.
unsafe impl Sync for Host {}

impl Host {
    /// A host that behaves so.
    pub fn new(behaviour: Behaviour) -> Self {
        let suites = Box::new(Suites::new(&behaviour));
        let inner = Arc::new(Inner::new(behaviour));
        // Nobody else has the host yet, so that the list is empty.
        let _ = inner.suites.set(suites.list(&inner.behaviour));
        let properties = Set::new(&inner, "host");
        properties.put(kOfxPropName, vec![inner.behaviour.name.into()]);
        properties.put(kOfxImageEffectPropSupportsTiles, vec![i32::from(inner.behaviour.tiles).into()]);
        let temporal = i32::from(inner.behaviour.temporal);
        properties.put(kOfxImageEffectPropTemporalClipAccess, vec![temporal.into()]);
        let mut depths = vec![kOfxBitDepthFloat, kOfxBitDepthShort, kOfxBitDepthByte];
        if inner.behaviour.half {
            depths.push(kOfxBitDepthHalf);
        }
        let depths = depths.into_iter().map(Value::from).collect();
        properties.put(kOfxImageEffectPropSupportedPixelDepths, depths);
        let raw = Box::new(OfxHost { host: properties.handle(), fetchSuite: Some(suites::fetch) });
        Self { inner, properties, raw, _suites: suites }
    }

    /// Pointer that plugins are given.
    pub fn raw(&self) -> *mut OfxHost {
        (&raw const *self.raw).cast_mut()
    }

    /// Its properties.
    pub fn properties(&self) -> &Set {
        &self.properties
    }

    /// Holds when no plugin did anything against the standard so far.
    ///
    /// # Panics
    /// When one did.
    pub fn no_faults(&self) {
        let faults = self.inner.faults();
        assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    }
}
