//! Types and lengths of the standard's properties, and which of them a host must have.

use isophote_abi::openfx::*;
use std::ffi::CStr;

/// More values than anyone sets.
const ANY: i32 = 1 << 16;

/// Type of a property and how many values it has at most; all others are one text. '?' is the type of the
/// parameter whose property it is.
const SHAPES: &[(&CStr, char, i32)] = &[
    (kOfxPropVersion, 'i', ANY),
    (kOfxPropIcon, 's', 2),
    (kOfxImagePropData, 'p', 1),
    (kOfxImagePropBounds, 'i', 4),
    (kOfxImagePropRegionOfDefinition, 'i', 4),
    (kOfxImageEffectPropRenderWindow, 'i', 4),
    (kOfxImageEffectPropRegionOfDefinition, 'd', 4),
    (kOfxImageEffectPropRegionOfInterest, 'd', 4),
    (kOfxImageEffectPropRenderScale, 'd', 2),
    (kOfxImageEffectPropProjectExtent, 'd', 2),
    (kOfxPropTime, 'd', 1),
    (kOfxImageEffectPropFrameRange, 'd', 2),
    (kOfxImagePropPixelAspectRatio, 'd', 1),
    (kOfxParamPropIncrement, 'd', 4),
    (kOfxImageEffectPropSupportedContexts, 's', ANY),
    (kOfxImageEffectPropSupportedPixelDepths, 's', ANY),
    (kOfxImageEffectPropSupportedComponents, 's', ANY),
    (kOfxParamPropChoiceOption, 's', ANY),
    (kOfxParamPropPageChild, 's', ANY),
    (kOfxImageEffectPropColourManagementAvailableConfigs, 's', ANY),
    (kOfxImageEffectPropClipPreferencesSlaveParam, 's', ANY),
    (kOfxParamPropDefault, '?', 4),
    (kOfxParamPropMin, '?', 4),
    (kOfxParamPropMax, '?', 4),
    (kOfxParamPropDisplayMin, '?', 4),
    (kOfxParamPropDisplayMax, '?', 4),
    (kOfxImageEffectPluginPropSingleInstance, 'i', 1),
    (kOfxImageEffectPluginPropHostFrameThreading, 'i', 1),
    (kOfxImageEffectPluginPropFieldRenderTwiceAlways, 'i', 1),
    (kOfxImageEffectPropSupportsMultiResolution, 'i', 1),
    (kOfxImageEffectPropSupportsTiles, 'i', 1),
    (kOfxImageEffectPropTemporalClipAccess, 'i', 1),
    (kOfxImageEffectPropSupportsMultipleClipDepths, 'i', 1),
    (kOfxImageEffectPropSupportsMultipleClipPARs, 'i', 1),
    (kOfxImageEffectInstancePropSequentialRender, 'i', 1),
    (kOfxImagePropRowBytes, 'i', 1),
    (kOfxImageClipPropOptional, 'i', 1),
    (kOfxImageClipPropIsMask, 'i', 1),
    (kOfxImageClipPropConnected, 'i', 1),
    (kOfxParamPropAnimates, 'i', 1),
    (kOfxImageEffectFrameVarying, 'i', 1),
    (kOfxParamPropEnabled, 'i', 1),
    (kOfxParamPropEvaluateOnChange, 'i', 1),
    (kOfxParamPropSecret, 'i', 1),
    (kOfxParamPropStringFilePathExists, 'i', 1),
    (kOfxImageEffectHostPropIsBackground, 'i', 1),
    (kOfxParamPropDigits, 'i', 1),
    (kOfxParamPropGroupOpen, 'i', 1),
];

/// Type of a property ('i', 'd', 's', 'p', or '?' for that of its parameter) and how many values it has at
/// most; `None` for a name that the standard does not have.
pub(super) fn shape(name: &CStr) -> Option<(char, i32)> {
    if name.to_bytes().starts_with(ROI_PREFIX.as_bytes()) {
        return Some(('d', 4));
    }
    if name.to_bytes().starts_with(FRAME_RANGE_PREFIX.as_bytes()) {
        return Some(('d', ANY));
    }
    if name == PIXEL_ORDER || name == PREFERRED_COLOURSPACES_OF_SOURCE {
        return Some(('s', 1));
    }
    if !STRINGS.iter().any(|(_, value)| *value == name) {
        return None;
    }
    let listed = SHAPES.iter().find(|(known, ..)| *known == name);
    Some(listed.map_or(('s', 1), |(_, kind, most)| (*kind, *most)))
}

/// Properties that no host can do without; all others may be refused.
pub(super) const REQUIRED: [&CStr; 16] = [
    kOfxImageEffectPropSupportedContexts,
    kOfxImageEffectPropSupportedPixelDepths,
    kOfxImageEffectPropSupportedComponents,
    kOfxImageEffectPropContext,
    kOfxImageEffectPropPixelDepth,
    kOfxImageEffectPropComponents,
    kOfxImagePropData,
    kOfxImagePropBounds,
    kOfxImagePropRowBytes,
    kOfxImageEffectPropRenderWindow,
    kOfxImageEffectPropRegionOfInterest,
    kOfxPropTime,
    kOfxParamPropDefault,
    kOfxParamPropChoiceOption,
    kOfxPropName,
    kOfxPropLabel,
];
