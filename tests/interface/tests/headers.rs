//! The declared interface against the `openfx` crate, which is made from the standard's headers.

use isophote_abi::openfx as ours;
use openfx::sys::generic::core as theirs_core;
use openfx::sys::generic::property as theirs_property;
use openfx::sys::image_effect_v1 as theirs;
use std::mem::{align_of, offset_of, size_of};

/// Names of the crate that the plugin and the host declare, in one place to be looked up by name.
mod all {
    pub use openfx::sys::generic::core::*;
    pub use openfx::sys::generic::property::*;
    pub use openfx::sys::image_effect_v1::colour::*;
    pub use openfx::sys::image_effect_v1::gpu_render::*;
    pub use openfx::sys::image_effect_v1::image_effect::*;
    pub use openfx::sys::image_effect_v1::message::*;
    pub use openfx::sys::image_effect_v1::multi_thread::*;
    pub use openfx::sys::image_effect_v1::param::*;
}

macro_rules! compare {
    ($($name:ident)*) => {
        /// Every constant of the crate that is compared.
        const COMPARED: &[&str] = &[$(stringify!($name)),*];

        #[test]
        fn constants_are_those_of_the_headers() {
            $(assert_eq!(ours::$name, all::$name, stringify!($name));)*
        }
    };
}

compare! {
    kOfxImageEffectPluginApi kOfxActionLoad kOfxActionUnload kOfxActionDescribe
    kOfxActionPurgeCaches kOfxActionCreateInstance kOfxActionDestroyInstance
    kOfxActionInstanceChanged kOfxImageEffectActionDescribeInContext
    kOfxImageEffectActionGetRegionOfDefinition kOfxImageEffectActionGetRegionsOfInterest
    kOfxImageEffectActionGetClipPreferences kOfxImageEffectActionIsIdentity
    kOfxImageEffectActionGetFramesNeeded kOfxImageEffectPropFrameRange kOfxMessageWarning
    kOfxMessageMessage
    kOfxImageEffectActionRender kOfxPropertySuite kOfxParameterSuite kOfxImageEffectSuite
    kOfxMultiThreadSuite kOfxMessageSuite kOfxPropName kOfxPropTime kOfxPropLabel kOfxPropShortLabel
    kOfxPropLongLabel kOfxPropVersion kOfxPropVersionLabel kOfxPropPluginDescription kOfxPropIcon
    kOfxMessageError kOfxImageEffectContextFilter kOfxImageEffectContextGeneral
    kOfxImageEffectPropContext kOfxImageEffectPropSupportedContexts
    kOfxImageEffectPropSupportedPixelDepths kOfxImageEffectPropSupportedComponents
    kOfxImageEffectPluginPropGrouping kOfxImageEffectPluginPropSingleInstance
    kOfxImageEffectPluginPropHostFrameThreading kOfxImageEffectPluginPropFieldRenderTwiceAlways
    kOfxImageEffectPluginRenderThreadSafety kOfxImageEffectRenderFullySafe
    kOfxImageEffectPropSupportsMultiResolution kOfxImageEffectPropSupportsTiles
    kOfxImageEffectPropTemporalClipAccess kOfxImageEffectPropSupportsMultipleClipDepths
    kOfxImageEffectPropSupportsMultipleClipPARs kOfxImageEffectInstancePropSequentialRender
    kOfxImageEffectPropNoSpatialAwareness kOfxImageEffectPropOpenGLRenderSupported
    kOfxImageEffectPropOpenCLRenderSupported kOfxImageEffectPropCudaRenderSupported
    kOfxImageEffectPropMetalRenderSupported kOfxImageEffectPropCPURenderSupported
    kOfxImageEffectPropPixelDepth kOfxBitDepthNone kOfxBitDepthByte kOfxBitDepthShort
    kOfxBitDepthHalf kOfxBitDepthFloat kOfxImageEffectPropComponents kOfxImageComponentNone
    kOfxImageComponentRGBA kOfxImageComponentRGB kOfxImageComponentAlpha
    kOfxImageEffectPropPreMultiplication kOfxImageOpaque kOfxImagePreMultiplied
    kOfxImageUnPreMultiplied kOfxImagePropData kOfxImagePropBounds kOfxImagePropRegionOfDefinition
    kOfxImagePropRowBytes kOfxImagePropPixelAspectRatio kOfxImagePropField kOfxImageFieldNone
    kOfxImageFieldLower kOfxImageFieldUpper kOfxImageFieldBoth kOfxImageFieldDoubled
    kOfxImageClipPropOptional kOfxImageClipPropIsMask kOfxImageClipPropConnected
    kOfxImageClipPropFieldExtraction kOfxImageClipPropFieldOrder kOfxImageEffectPropRenderScale
    kOfxImageEffectPropRenderWindow kOfxImageEffectPropFieldToRender
    kOfxImageEffectPropRegionOfDefinition kOfxImageEffectPropRegionOfInterest kOfxParamTypeInteger
    kOfxParamTypeDouble kOfxParamTypeBoolean kOfxParamTypeChoice kOfxParamTypeRGBA
    kOfxImageEffectFrameVarying kOfxImageEffectPropRenderQualityDraft
    kOfxParamTypeString kOfxParamTypePushButton kOfxParamPropEvaluateOnChange kOfxParamPropSecret
    kOfxParamPropStringMode kOfxParamPropStringFilePathExists kOfxParamStringIsFilePath
    kOfxParamTypeGroup kOfxParamTypePage kOfxParamPropAnimates kOfxParamPropScriptName
    kOfxParamPropHint kOfxParamPropDefault kOfxParamPropMin kOfxParamPropMax kOfxParamPropDisplayMin
    kOfxParamPropDisplayMax kOfxParamPropIncrement kOfxParamPropDigits kOfxParamPropDoubleType
    kOfxParamDoubleTypePlain kOfxParamDoubleTypeAngle kOfxParamPropChoiceOption kOfxParamPropParent
    kOfxParamPropGroupOpen kOfxParamPropPageChild kOfxImageEffectPropColourManagementStyle
    kOfxImageEffectColourManagementNone kOfxImageEffectColourManagementBasic
    kOfxImageEffectPropColourManagementAvailableConfigs kOfxImageClipPropColourspace
    kOfxImageEffectActionGetOutputColourspace kOfxImageEffectPropClipPreferencesSlaveParam
    kOfxChangePluginEdited kOfxChangeTime kOfxChangeUserEdited kOfxImageEffectHostPropIsBackground
    kOfxImageEffectPropProjectExtent kOfxParamPropEnabled kOfxPropChangeReason kOfxPropType kOfxTypeClip
    kOfxTypeParameter kOfxStatOK kOfxStatFailed kOfxStatErrUnknown
    kOfxStatErrMissingHostFeature kOfxStatErrExists kOfxStatErrMemory kOfxStatErrBadHandle
    kOfxStatErrBadIndex kOfxStatErrValue kOfxStatReplyDefault kOfxStatErrImageFormat
}

#[test]
fn every_constant_is_compared() {
    let names = ours::STRINGS.iter().map(|(n, _)| n).chain(ours::STATUSES.iter().map(|(n, _)| n));
    for name in names {
        assert!(COMPARED.contains(name), "{name}");
    }
    assert_eq!(ours::kOfxImageEffectPluginApiVersion as u32, all::kOfxImageEffectPluginApiVersion);
}

macro_rules! same_layout {
    ($ours:ty, $theirs:ty: $($field:ident)*) => {
        assert_eq!(size_of::<$ours>(), size_of::<$theirs>(), stringify!($ours));
        assert_eq!(align_of::<$ours>(), align_of::<$theirs>(), stringify!($ours));
        $(assert_eq!(offset_of!($ours, $field), offset_of!($theirs, $field), stringify!($field));)*
    };
}

#[test]
fn layouts_are_those_of_the_headers() {
    same_layout!(ours::OfxHost, theirs_core::OfxHost: host fetchSuite);
    same_layout!(ours::OfxRectD, theirs_core::OfxRectD: x1 y1 x2 y2);
    same_layout!(
        ours::OfxPlugin, theirs_core::OfxPlugin:
        pluginApi apiVersion pluginIdentifier pluginVersionMajor pluginVersionMinor setHost mainEntry
    );
    same_layout!(
        ours::OfxPropertySuiteV1, theirs_property::OfxPropertySuiteV1:
        propSetPointer propSetString propSetDouble propSetInt propSetPointerN propSetStringN propSetDoubleN
        propSetIntN propGetPointer propGetString propGetDouble propGetInt propGetPointerN propGetStringN
        propGetDoubleN propGetIntN propReset propGetDimension
    );
    same_layout!(
        ours::OfxImageEffectSuiteV1, theirs::image_effect::OfxImageEffectSuiteV1:
        getPropertySet getParamSet clipDefine clipGetHandle clipGetPropertySet clipGetImage clipReleaseImage
        clipGetRegionOfDefinition abort imageMemoryAlloc imageMemoryFree imageMemoryLock imageMemoryUnlock
    );
    same_layout!(
        ours::OfxParameterSuiteV1, theirs::param::OfxParameterSuiteV1:
        paramDefine paramGetHandle paramSetGetPropertySet paramGetPropertySet paramGetValue paramGetValueAtTime
        paramGetDerivative paramGetIntegral paramSetValue paramSetValueAtTime paramGetNumKeys paramGetKeyTime
        paramGetKeyIndex paramDeleteKey paramDeleteAllKeys paramCopy paramEditBegin paramEditEnd
    );
    same_layout!(
        ours::OfxMultiThreadSuiteV1, theirs::multi_thread::OfxMultiThreadSuiteV1:
        multiThread multiThreadNumCPUs multiThreadIndex multiThreadIsSpawnedThread mutexCreate mutexDestroy
        mutexLock mutexUnLock mutexTryLock
    );
    same_layout!(ours::OfxMessageSuiteV1, theirs::message::OfxMessageSuiteV1: message);
    same_layout!(
        ours::OfxMessageSuiteV2, theirs::message::OfxMessageSuiteV2:
        message setPersistentMessage clearPersistentMessage
    );
}
