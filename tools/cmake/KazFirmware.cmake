# What the firmware is made of.

# Sources of shared/servo that run on the H8 too, relative to shared/.
function(kaz_servo_sources out)
  set(${out} servo/tick.c servo/joints.c servo/requests.c servo/commands.c servo/safety.c
             servo/outputs.c PARENT_SCOPE)
endfunction()
