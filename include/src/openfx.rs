//! The OpenFX C interface, as far as the plugin and its test host use it: the names, numbers, layouts
//! and function types of the Image Effect API 1.4, with what 1.5 adds to descriptors.
//!
//! Declared by hand, so that no C header is needed to build; a test compares every constant and
//! layout with the `openfx` crate.

#![allow(non_upper_case_globals, non_snake_case, missing_docs, reason = "the standard's own names")]

use core::ffi::{CStr, c_char, c_int, c_uint, c_void};

/// Declares strings, and lists them for the test that compares them.
macro_rules! strings {
    ($($name:ident = $value:literal;)*) => {
        $(pub const $name: &CStr = $value;)*
        /// Every string above, by its name.
        #[allow(dead_code, reason = "the test of this file reads it")]
        pub const STRINGS: &[(&str, &CStr)] = &[$((stringify!($name), $name)),*];
    };
}

strings! {
    kOfxImageEffectPluginApi = c"OfxImageEffectPluginAPI";

    kOfxActionLoad = c"OfxActionLoad";
    kOfxActionUnload = c"OfxActionUnload";
    kOfxActionDescribe = c"OfxActionDescribe";
    kOfxActionPurgeCaches = c"OfxActionPurgeCaches";
    kOfxActionCreateInstance = c"OfxActionCreateInstance";
    kOfxActionDestroyInstance = c"OfxActionDestroyInstance";
    kOfxActionInstanceChanged = c"OfxActionInstanceChanged";
    kOfxImageEffectActionDescribeInContext = c"OfxImageEffectActionDescribeInContext";
    kOfxImageEffectActionGetRegionOfDefinition = c"OfxImageEffectActionGetRegionOfDefinition";
    kOfxImageEffectActionGetRegionsOfInterest = c"OfxImageEffectActionGetRegionsOfInterest";
    kOfxImageEffectActionGetClipPreferences = c"OfxImageEffectActionGetClipPreferences";
    kOfxImageEffectActionIsIdentity = c"OfxImageEffectActionIsIdentity";
    kOfxImageEffectActionGetFramesNeeded = c"OfxImageEffectActionGetFramesNeeded";
    kOfxImageEffectActionRender = c"OfxImageEffectActionRender";

    kOfxPropertySuite = c"OfxPropertySuite";
    kOfxParameterSuite = c"OfxParameterSuite";
    kOfxImageEffectSuite = c"OfxImageEffectSuite";
    kOfxMultiThreadSuite = c"OfxMultiThreadSuite";
    kOfxMessageSuite = c"OfxMessageSuite";

    kOfxPropName = c"OfxPropName";
    kOfxPropTime = c"OfxPropTime";
    kOfxPropType = c"OfxPropType";
    kOfxTypeParameter = c"OfxTypeParameter";
    kOfxTypeClip = c"OfxTypeClip";
    kOfxPropChangeReason = c"OfxPropChangeReason";
    kOfxChangeUserEdited = c"OfxChangeUserEdited";
    kOfxChangePluginEdited = c"OfxChangePluginEdited";
    kOfxChangeTime = c"OfxChangeTime";
    kOfxPropLabel = c"OfxPropLabel";
    kOfxPropShortLabel = c"OfxPropShortLabel";
    kOfxPropLongLabel = c"OfxPropLongLabel";
    kOfxPropVersion = c"OfxPropVersion";
    kOfxPropVersionLabel = c"OfxPropVersionLabel";
    kOfxPropPluginDescription = c"OfxPropPluginDescription";
    kOfxPropIcon = c"OfxPropIcon";
    kOfxMessageError = c"OfxMessageError";
    kOfxMessageWarning = c"OfxMessageWarning";
    kOfxMessageMessage = c"OfxMessageMessage";

    kOfxImageEffectPropColourManagementStyle = c"OfxImageEffectPropColourManagementStyle";
    kOfxImageEffectColourManagementNone = c"OfxImageEffectColourManagementNone";
    kOfxImageEffectColourManagementBasic = c"OfxImageEffectColourManagementBasic";
    kOfxImageEffectPropColourManagementAvailableConfigs = c"OfxImageEffectPropColourManagementAvailableConfigs";
    kOfxImageClipPropColourspace = c"OfxImageClipPropColourspace";
    kOfxImageEffectActionGetOutputColourspace = c"OfxImageEffectActionGetOutputColourspace";
    kOfxImageEffectPropClipPreferencesSlaveParam = c"OfxImageEffectPropClipPreferencesSlaveParam";

    kOfxImageEffectContextFilter = c"OfxImageEffectContextFilter";
    kOfxImageEffectContextGeneral = c"OfxImageEffectContextGeneral";
    kOfxImageEffectPropContext = c"OfxImageEffectPropContext";
    kOfxImageEffectPropSupportedContexts = c"OfxImageEffectPropSupportedContexts";
    kOfxImageEffectPropSupportedPixelDepths = c"OfxImageEffectPropSupportedPixelDepths";
    kOfxImageEffectPropSupportedComponents = c"OfxImageEffectPropSupportedComponents";
    kOfxImageEffectPluginPropGrouping = c"OfxImageEffectPluginPropGrouping";
    kOfxImageEffectPluginPropSingleInstance = c"OfxImageEffectPluginPropSingleInstance";
    kOfxImageEffectPluginPropHostFrameThreading = c"OfxImageEffectPluginPropHostFrameThreading";
    kOfxImageEffectPluginPropFieldRenderTwiceAlways = c"OfxImageEffectPluginPropFieldRenderTwiceAlways";
    kOfxImageEffectPluginRenderThreadSafety = c"OfxImageEffectPluginRenderThreadSafety";
    kOfxImageEffectRenderFullySafe = c"OfxImageEffectRenderFullySafe";
    kOfxImageEffectPropSupportsMultiResolution = c"OfxImageEffectPropSupportsMultiResolution";
    kOfxImageEffectPropSupportsTiles = c"OfxImageEffectPropSupportsTiles";
    kOfxImageEffectPropTemporalClipAccess = c"OfxImageEffectPropTemporalClipAccess";
    kOfxImageEffectPropSupportsMultipleClipDepths = c"OfxImageEffectPropMultipleClipDepths";
    kOfxImageEffectPropSupportsMultipleClipPARs = c"OfxImageEffectPropSupportsMultipleClipPARs";
    kOfxImageEffectInstancePropSequentialRender = c"OfxImageEffectInstancePropSequentialRender";
    kOfxImageEffectPropNoSpatialAwareness = c"OfxImageEffectPropNoSpatialAwareness";
    kOfxImageEffectPropOpenGLRenderSupported = c"OfxImageEffectPropOpenGLRenderSupported";
    kOfxImageEffectPropOpenCLRenderSupported = c"OfxImageEffectPropOpenCLRenderSupported";
    kOfxImageEffectPropCudaRenderSupported = c"OfxImageEffectPropCudaRenderSupported";
    kOfxImageEffectPropMetalRenderSupported = c"OfxImageEffectPropMetalRenderSupported";
    kOfxImageEffectPropCPURenderSupported = c"OfxImageEffectPropCPURenderSupported";

    kOfxImageEffectPropPixelDepth = c"OfxImageEffectPropPixelDepth";
    kOfxBitDepthNone = c"OfxBitDepthNone";
    kOfxBitDepthByte = c"OfxBitDepthByte";
    kOfxBitDepthShort = c"OfxBitDepthShort";
    kOfxBitDepthHalf = c"OfxBitDepthHalf";
    kOfxBitDepthFloat = c"OfxBitDepthFloat";
    kOfxImageEffectPropComponents = c"OfxImageEffectPropComponents";
    kOfxImageComponentNone = c"OfxImageComponentNone";
    kOfxImageComponentRGBA = c"OfxImageComponentRGBA";
    kOfxImageComponentRGB = c"OfxImageComponentRGB";
    kOfxImageComponentAlpha = c"OfxImageComponentAlpha";
    kOfxImageEffectFrameVarying = c"OfxImageEffectFrameVarying";
    kOfxImageEffectPropRenderQualityDraft = c"OfxImageEffectPropRenderQualityDraft";
    kOfxImageEffectPropPreMultiplication = c"OfxImageEffectPropPreMultiplication";
    kOfxImageOpaque = c"OfxImageOpaque";
    kOfxImagePreMultiplied = c"OfxImageAlphaPremultiplied";
    kOfxImageUnPreMultiplied = c"OfxImageAlphaUnPremultiplied";
    kOfxImagePropData = c"OfxImagePropData";
    kOfxImagePropBounds = c"OfxImagePropBounds";
    kOfxImagePropRegionOfDefinition = c"OfxImagePropRegionOfDefinition";
    kOfxImagePropRowBytes = c"OfxImagePropRowBytes";
    kOfxImagePropPixelAspectRatio = c"OfxImagePropPixelAspectRatio";
    kOfxImagePropField = c"OfxImagePropField";
    kOfxImageFieldNone = c"OfxFieldNone";
    kOfxImageFieldLower = c"OfxFieldLower";
    kOfxImageFieldUpper = c"OfxFieldUpper";
    kOfxImageFieldBoth = c"OfxFieldBoth";
    kOfxImageFieldDoubled = c"OfxFieldDoubled";

    kOfxImageClipPropOptional = c"OfxImageClipPropOptional";
    kOfxImageClipPropIsMask = c"OfxImageClipPropIsMask";
    kOfxImageClipPropConnected = c"OfxImageClipPropConnected";
    kOfxImageClipPropFieldExtraction = c"OfxImageClipPropFieldExtraction";
    kOfxImageClipPropFieldOrder = c"OfxImageClipPropFieldOrder";

    kOfxImageEffectHostPropIsBackground = c"OfxImageEffectHostPropIsBackground";
    kOfxImageEffectPropProjectExtent = c"OfxImageEffectPropProjectExtent";
    kOfxImageEffectPropFrameRange = c"OfxImageEffectPropFrameRange";
    kOfxImageEffectPropRenderScale = c"OfxImageEffectPropRenderScale";
    kOfxImageEffectPropRenderWindow = c"OfxImageEffectPropRenderWindow";
    kOfxImageEffectPropFieldToRender = c"OfxImageEffectPropFieldToRender";
    kOfxImageEffectPropRegionOfDefinition = c"OfxImageEffectPropRegionOfDefinition";
    kOfxImageEffectPropRegionOfInterest = c"OfxImageEffectPropRegionOfInterest";

    kOfxParamTypeInteger = c"OfxParamTypeInteger";
    kOfxParamTypeDouble = c"OfxParamTypeDouble";
    kOfxParamTypeBoolean = c"OfxParamTypeBoolean";
    kOfxParamTypeChoice = c"OfxParamTypeChoice";
    kOfxParamTypeRGBA = c"OfxParamTypeRGBA";
    kOfxParamTypeString = c"OfxParamTypeString";
    kOfxParamTypePushButton = c"OfxParamTypePushButton";
    kOfxParamTypeGroup = c"OfxParamTypeGroup";
    kOfxParamTypePage = c"OfxParamTypePage";
    kOfxParamPropAnimates = c"OfxParamPropAnimates";
    kOfxParamPropEnabled = c"OfxParamPropEnabled";
    kOfxParamPropEvaluateOnChange = c"OfxParamPropEvaluateOnChange";
    kOfxParamPropSecret = c"OfxParamPropSecret";
    kOfxParamPropStringMode = c"OfxParamPropStringMode";
    kOfxParamPropStringFilePathExists = c"OfxParamPropStringFilePathExists";
    kOfxParamStringIsFilePath = c"OfxParamStringIsFilePath";
    kOfxParamPropScriptName = c"OfxParamPropScriptName";
    kOfxParamPropHint = c"OfxParamPropHint";
    kOfxParamPropDefault = c"OfxParamPropDefault";
    kOfxParamPropMin = c"OfxParamPropMin";
    kOfxParamPropMax = c"OfxParamPropMax";
    kOfxParamPropDisplayMin = c"OfxParamPropDisplayMin";
    kOfxParamPropDisplayMax = c"OfxParamPropDisplayMax";
    kOfxParamPropIncrement = c"OfxParamPropIncrement";
    kOfxParamPropDigits = c"OfxParamPropDigits";
    kOfxParamPropDoubleType = c"OfxParamPropDoubleType";
    kOfxParamDoubleTypePlain = c"OfxParamDoubleTypePlain";
    kOfxParamDoubleTypeAngle = c"OfxParamDoubleTypeAngle";
    kOfxParamPropChoiceOption = c"OfxParamPropChoiceOption";
    kOfxParamPropParent = c"OfxParamPropParent";
    kOfxParamPropGroupOpen = c"OfxParamPropGroupOpen";
    kOfxParamPropPageChild = c"OfxParamPropPageChild";
}

/// Of one host's own: the order of the channels of an image.
pub const PIXEL_ORDER: &CStr = c"OfxImageEffectPropPixelOrder";
/// Of one host's own: blue first.
pub const PIXEL_ORDER_BGRA: &CStr = c"OfxImagePixelOrderBGRA";
/// Prefix of the name of a clip in the answer to `GetRegionsOfInterest`.
pub const ROI_PREFIX: &str = "OfxImageClipPropRoI_";
/// Prefix of the name of a clip in the answer to `GetFramesNeeded`.
pub const FRAME_RANGE_PREFIX: &str = "OfxImageClipPropFrameRange_";
/// Prefix of the name of a clip in the answer to `GetClipPreferences`.
#[allow(dead_code, reason = "the test host reads it")]
pub const COMPONENTS_PREFIX: &str = "OfxImageClipPropComponents_";

/// Prefix of the name of the source in the answer to `GetClipPreferences`.
pub const PREFERRED_COLOURSPACES_OF_SOURCE: &CStr = c"OfxImageClipPropPreferredColourspaces_Source";
/// The list of colour spaces that names are taken from.
pub const COLOURSPACES: &CStr = c"ofx-native-v1.5_aces-v1.3_ocio-v2.3";
/// The colour space of the source, whichever it is.
pub const COLOURSPACE_OF_SOURCE: &CStr = c"OfxColourspace_Source";

pub const kOfxImageEffectPluginApiVersion: c_int = 1;

pub type OfxStatus = c_int;
/// Declares statuses, and lists them as [`STRINGS`] are.
macro_rules! statuses {
    ($($name:ident = $value:literal;)*) => {
        $(#[allow(dead_code, reason = "each side uses some")] pub const $name: OfxStatus = $value;)*
        /// Every status, by its name.
        #[allow(dead_code, reason = "the test of this file reads it")]
        pub const STATUSES: &[(&str, OfxStatus)] = &[$((stringify!($name), $value)),*];
    };
}

statuses! {
    kOfxStatOK = 0;
    kOfxStatFailed = 1;
    kOfxStatErrUnknown = 3;
    kOfxStatErrMissingHostFeature = 4;
    kOfxStatErrExists = 6;
    kOfxStatErrMemory = 8;
    kOfxStatErrBadHandle = 9;
    kOfxStatErrBadIndex = 10;
    kOfxStatErrValue = 11;
    kOfxStatReplyDefault = 14;
    kOfxStatErrImageFormat = 1000;
}

pub type OfxTime = f64;
/// A thing of the host's: it is handed back and never looked into.
pub type Handle = *mut c_void;

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfxRectD {
    pub x1: f64,
    pub y1: f64,
    pub x2: f64,
    pub y2: f64,
}

pub type FetchSuite = unsafe extern "C" fn(Handle, *const c_char, c_int) -> *const c_void;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxHost {
    pub host: Handle,
    pub fetchSuite: Option<FetchSuite>,
}

pub type SetHost = unsafe extern "C" fn(*mut OfxHost);
pub type MainEntry = unsafe extern "C" fn(*const c_char, *const c_void, Handle, Handle) -> OfxStatus;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxPlugin {
    pub pluginApi: *const c_char,
    pub apiVersion: c_int,
    pub pluginIdentifier: *const c_char,
    pub pluginVersionMajor: c_uint,
    pub pluginVersionMinor: c_uint,
    pub setHost: Option<SetHost>,
    pub mainEntry: Option<MainEntry>,
}

type Set<T> = Option<unsafe extern "C" fn(Handle, *const c_char, c_int, T) -> OfxStatus>;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxPropertySuiteV1 {
    pub propSetPointer: Set<*mut c_void>,
    pub propSetString: Set<*const c_char>,
    pub propSetDouble: Set<f64>,
    pub propSetInt: Set<c_int>,
    pub propSetPointerN: Set<*const *mut c_void>,
    pub propSetStringN: Set<*const *const c_char>,
    pub propSetDoubleN: Set<*const f64>,
    pub propSetIntN: Set<*const c_int>,
    pub propGetPointer: Set<*mut *mut c_void>,
    pub propGetString: Set<*mut *mut c_char>,
    pub propGetDouble: Set<*mut f64>,
    pub propGetInt: Set<*mut c_int>,
    pub propGetPointerN: Set<*mut *mut c_void>,
    pub propGetStringN: Set<*mut *mut c_char>,
    pub propGetDoubleN: Set<*mut f64>,
    pub propGetIntN: Set<*mut c_int>,
    pub propReset: Option<unsafe extern "C" fn(Handle, *const c_char) -> OfxStatus>,
    pub propGetDimension: Option<unsafe extern "C" fn(Handle, *const c_char, *mut c_int) -> OfxStatus>,
}

type Named = Option<unsafe extern "C" fn(Handle, *const c_char, *mut Handle, *mut Handle) -> OfxStatus>;
type Of = Option<unsafe extern "C" fn(Handle, *mut Handle) -> OfxStatus>;
type Done = Option<unsafe extern "C" fn(Handle) -> OfxStatus>;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxImageEffectSuiteV1 {
    pub getPropertySet: Of,
    pub getParamSet: Of,
    pub clipDefine: Option<unsafe extern "C" fn(Handle, *const c_char, *mut Handle) -> OfxStatus>,
    pub clipGetHandle: Named,
    pub clipGetPropertySet: Of,
    pub clipGetImage:
        Option<unsafe extern "C" fn(Handle, OfxTime, *const OfxRectD, *mut Handle) -> OfxStatus>,
    pub clipReleaseImage: Done,
    pub clipGetRegionOfDefinition: Option<unsafe extern "C" fn(Handle, OfxTime, *mut OfxRectD) -> OfxStatus>,
    pub abort: Option<unsafe extern "C" fn(Handle) -> c_int>,
    pub imageMemoryAlloc: Option<unsafe extern "C" fn(Handle, usize, *mut Handle) -> OfxStatus>,
    pub imageMemoryFree: Done,
    pub imageMemoryLock: Option<unsafe extern "C" fn(Handle, *mut *mut c_void) -> OfxStatus>,
    pub imageMemoryUnlock: Done,
}

type Variadic = Option<unsafe extern "C" fn(Handle, ...) -> OfxStatus>;
type VariadicAt = Option<unsafe extern "C" fn(Handle, OfxTime, ...) -> OfxStatus>;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxParameterSuiteV1 {
    pub paramDefine:
        Option<unsafe extern "C" fn(Handle, *const c_char, *const c_char, *mut Handle) -> OfxStatus>,
    pub paramGetHandle: Named,
    pub paramSetGetPropertySet: Of,
    pub paramGetPropertySet: Of,
    pub paramGetValue: Variadic,
    pub paramGetValueAtTime: VariadicAt,
    pub paramGetDerivative: VariadicAt,
    pub paramGetIntegral: Option<unsafe extern "C" fn(Handle, OfxTime, OfxTime, ...) -> OfxStatus>,
    pub paramSetValue: Variadic,
    pub paramSetValueAtTime: VariadicAt,
    pub paramGetNumKeys: Option<unsafe extern "C" fn(Handle, *mut c_uint) -> OfxStatus>,
    pub paramGetKeyTime: Option<unsafe extern "C" fn(Handle, c_uint, *mut OfxTime) -> OfxStatus>,
    pub paramGetKeyIndex: Option<unsafe extern "C" fn(Handle, OfxTime, c_int, *mut c_int) -> OfxStatus>,
    pub paramDeleteKey: Option<unsafe extern "C" fn(Handle, OfxTime) -> OfxStatus>,
    pub paramDeleteAllKeys: Done,
    pub paramCopy: Option<unsafe extern "C" fn(Handle, Handle, OfxTime, *const c_void) -> OfxStatus>,
    pub paramEditBegin: Option<unsafe extern "C" fn(Handle, *const c_char) -> OfxStatus>,
    pub paramEditEnd: Done,
}

pub type ThreadFunction = unsafe extern "C" fn(c_uint, c_uint, *mut c_void);

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxMultiThreadSuiteV1 {
    pub multiThread: Option<unsafe extern "C" fn(Option<ThreadFunction>, c_uint, *mut c_void) -> OfxStatus>,
    pub multiThreadNumCPUs: Option<unsafe extern "C" fn(*mut c_uint) -> OfxStatus>,
    pub multiThreadIndex: Option<unsafe extern "C" fn(*mut c_uint) -> OfxStatus>,
    pub multiThreadIsSpawnedThread: Option<unsafe extern "C" fn() -> c_int>,
    pub mutexCreate: Option<unsafe extern "C" fn(*mut Handle, c_int) -> OfxStatus>,
    pub mutexDestroy: Done,
    pub mutexLock: Done,
    pub mutexUnLock: Done,
    pub mutexTryLock: Done,
}

type Message =
    Option<unsafe extern "C" fn(*mut c_void, *const c_char, *const c_char, *const c_char, ...) -> OfxStatus>;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxMessageSuiteV1 {
    pub message: Message,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OfxMessageSuiteV2 {
    pub message: Message,
    pub setPersistentMessage: Message,
    pub clearPersistentMessage: Done,
}
