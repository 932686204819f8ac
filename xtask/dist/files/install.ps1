# Installs the OpenFX plugin of this folder, or removes it.
param(
    [string]$To = "$env:CommonProgramFiles\OFX\Plugins",
    [switch]$Remove
)
$ErrorActionPreference = "Stop"
$name = "Isophote.ofx.bundle"
$target = Join-Path $To $name
if (Test-Path $target) { Remove-Item -Recurse -Force $target }
if ($Remove) {
    Write-Output "removed $target"
    exit 0
}
New-Item -ItemType Directory -Force $To | Out-Null
# Hosts look for names that end in .bundle: it bears the name only when it is whole.
$new = Join-Path $To ".$name.new"
if (Test-Path $new) { Remove-Item -Recurse -Force $new }
Copy-Item -Recurse (Join-Path $PSScriptRoot $name) $new
Move-Item $new $target
Write-Output "installed $target"
Write-Output "Start the host anew. OPENFX.md says what each host remembers of an older version."
