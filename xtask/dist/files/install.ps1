# Installs what is in this folder, or removes it: the OpenFX plugin for all users, panels for Shotcut and Kdenlive for the
# user who runs this.
param(
    [string]$To,
    [switch]$Shotcut,
    [switch]$Kdenlive,
    [switch]$Remove
)
$ErrorActionPreference = "Stop"
if ($Shotcut) {
    $from = Join-Path $PSScriptRoot "shotcut"
    if (-not $To) { $To = "$env:LOCALAPPDATA\Meltytech\Shotcut\extensions\filters" }
} elseif ($Kdenlive) {
    $from = Join-Path $PSScriptRoot "kdenlive"
    if (-not $To) { $To = "$env:APPDATA\kdenlive\effects" }
} else {
    $from = $PSScriptRoot
    if (-not $To) { $To = "$env:CommonProgramFiles\OFX\Plugins" }
}
$names = Get-ChildItem $from | Where-Object { $Shotcut -or $Kdenlive -or $_.Name -eq "Isophote.ofx.bundle" }
New-Item -ItemType Directory -Force $To | Out-Null
foreach ($item in $names) {
    $target = Join-Path $To $item.Name
    if ($Remove) {
        if (Test-Path $target) { Remove-Item -Recurse -Force $target }
        continue
    }
    # Hosts look for names with their own ending: it bears the name only when it is whole.
    $new = Join-Path $To ".$($item.Name).new"
    if (Test-Path $new) { Remove-Item -Recurse -Force $new }
    Copy-Item -Recurse $item.FullName $new
    if (Test-Path $target) { Remove-Item -Recurse -Force $target }
    Move-Item $new $target
}
if ($Remove) {
    Write-Output "removed from $To"
} else {
    Write-Output "installed into $To"
    Write-Output "Start the host anew. OPENFX.md says what each host remembers of an older version."
}
